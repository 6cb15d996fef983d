#include <prep/requirements.h>
#include <prep/version.h>
#include <rast/version.h>

#include <cstdio>

int main() {
    prep::Scene scene;
    scene.meshes.emplace_back().positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    scene.meshes[0].corner_vertices = {0, 1, 2};
    scene.meshes[0].face_offsets = {0, 3};
    std::printf("prep %s, rast %s: %s\n", prep::version().data(), rast::version().data(),
                prep::requirements(scene)[0].normals.reason.c_str());
}
