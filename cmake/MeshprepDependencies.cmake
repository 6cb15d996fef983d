# Every third-party package, named once: the build finds them with find_package, the installed
# meshprepConfig.cmake with find_dependency. Each is linked PRIVATE by the library that wraps it.
set(meshprep_dependencies
  Threads glm TBB nlohmann_json FastFloat meshoptimizer draco assimp hwy fmt OpenMesh
  OpenImageIOLibrary PNG JPEG ZLIB CGALHeaders OpenSubdiv)
