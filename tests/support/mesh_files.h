// For tests of readers and writers: scenes written as they are, and meshes compared by bits.
#pragma once

#include <cstddef>
#include <span>
#include <string>

#include "prep/prepare.h"
#include "temporary_files.h"

namespace test {

// A reader's result for a file of this text; fails the test where the scene breaks a promise of
// prep/mesh.h.
prep::Result<prep::Scene> parsed(prep::Result<prep::Scene> (*parse)(std::span<const std::byte>,
                                                                    const std::string&),
                                 const std::string& text, const std::string& name);
std::string error_of(const prep::Result<prep::Scene>& result);  // in words, or "no error"

// Split into vertices with nothing computed: what a writer gets when nothing was asked for.
prep::PreparedScene untouched(prep::Scene scene);

// What differs between the two, face by face and corner by corner, in world coordinates and by
// bits: sizes of faces, positions, normals, first UV set, first colours. Empty where nothing does.
std::string corner_difference(const prep::Mesh& a, const prep::Mesh& b);
// The same for every list of the mesh but its name, indices included.
std::string exact_difference(const prep::Mesh& a, const prep::Mesh& b);

}  // namespace test
