// `meshprep prepare`, of one file: what is asked, and what became of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "meshprep/commands/batch_sources.h"
#include "meshprep/files/file_list.h"
#include "meshprep/files/input_file.h"
#include "meshprep/files/manifest.h"
#include "meshprep/files/output_directories.h"
#include "meshprep/options/camera_options.h"
#include "meshprep/options/common_options.h"
#include "meshprep/output/console.h"
#include "meshprep/output/counts.h"
#include "prep/prep.h"
#include "prep/render_choices.h"

namespace meshprep {

struct PrepareCommand {
    CommonOptions common;
    JobRequest files;
    bool explain = false, strict = false;
    double scale = 1;
    prep::Axis up = prep::Axis::y;
    prep::Compression compression = prep::Compression::keep;
    int jobs = 1;  // files at once; 0: as many as there are cores
    std::filesystem::path manifest;
    bool skip_unchanged = false;
    Settings settings;  // what was given of what decides about the output
    prep::PrepareOptions prepare;
    CameraWishes camera;         // of the picture that pixel errors are meant in,
    prep::RenderWishes picture;  // and its size
};

// What became of one file.
struct Outcome {
    Job job;
    std::optional<prep::Error> error;
    bool skipped = false;  // an earlier run's output is what this one's would be
    std::vector<HashedFile> sources;
    std::vector<std::filesystem::path> written;
    bool complete = true;  // all that the input names was found
    std::string bytes;     // for standard output
    Counts before, after, gltf_before, gltf_after;
    Counts parts;  // of a scene that is no glTF file: skins, animations, …
    prep::Placement placement;
    prep::SplitCounts splits;
    std::vector<prep::StageReport> stages;
    std::vector<prep::Finding> findings;
    std::vector<prep::RepairStep> repairs;
    std::vector<std::optional<prep::TessellationCertificate>> tessellated;  // by mesh
    std::vector<prep::ResidualMap> residual_maps;
    std::vector<std::string> residual_names;  // of their materials
    std::vector<std::string> mesh_names;
    std::vector<std::string> warnings, remarks, notes;
    double read_ms = 0, prepare_ms = 0, write_ms = 0;
    std::uint64_t bytes_before = 0, bytes_after = 0;  // of all files read, and written

    std::size_t warning_count() const;
};

// Reads, prepares and writes one file, a job of those of `sources`; `prefix` begins what is shown
// of its progress. Whatever goes wrong is the outcome's error.
Outcome prepare_file(const Job& job, const PrepareCommand& command, int threads,
                     OutputDirectories& directories, SiblingLinks& links, BatchSources& sources,
                     Console& console, const std::string& prefix);

}  // namespace meshprep
