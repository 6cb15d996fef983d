#include <new>

#include "meshprep/commands/commands.h"

namespace meshprep {
namespace {

struct Runner {
    Console& console;
    int operator()(const PrepareCommand& c) const { return run_prepare(c, console); }
    int operator()(const InspectCommand& c) const { return run_inspect(c, console); }
    int operator()(const RenderCommand& c) const { return run_render(c, console); }
    int operator()(const ValidateCommand& c) const { return run_validate(c, console); }
    int operator()(const DiffCommand& c) const { return run_diff(c, console); }
};

}  // namespace

int run(int argc, const char* const* argv, std::ostream& out, std::ostream& err,
        bool err_is_terminal) {
    const Arguments arguments = parse_arguments(argc, argv);
    out << arguments.out;
    err << arguments.err;
    int code = arguments.exit_code;
    if (arguments.command) {
        Console console(out, err, err_is_terminal);
        code = exit_failed;
        try {
            code = std::visit(Runner{console}, *arguments.command);
        } catch (const std::bad_alloc&) {
            console.error("out of memory; nothing was half written");
        }
    }
    out.flush();
    if (!out) {
        err << "meshprep: error: standard output cannot be written\n";
        return exit_failed;
    }
    return code;
}

}  // namespace meshprep
