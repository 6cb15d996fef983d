#include "formats/reader_backend.h"

// The name carries the version and a hash of the types, so that a library of another build is never
// taken for this one's.
extern "C" __attribute__((visibility("default"))) const prep::detail::ReaderBackend*
MESHPREP_READER_BACKEND() {
    static const prep::detail::ReaderBackend backend{
        prep::detail::read_om, prep::detail::read_with_assimp, prep::detail::assimp_knows};
    return &backend;
}
