#include "meshprep/commands/subcommand.h"

namespace meshprep {

Subcommand prepare_subcommand();
Subcommand inspect_subcommand();
Subcommand render_subcommand();
Subcommand validate_subcommand();
Subcommand cost_subcommand();
Subcommand diff_subcommand();
Subcommand height_to_normal_subcommand();

std::vector<Subcommand> subcommands() {
    return {prepare_subcommand(),         inspect_subcommand(), render_subcommand(),
            validate_subcommand(),        cost_subcommand(),    diff_subcommand(),
            height_to_normal_subcommand()};
}

}  // namespace meshprep
