// `meshprep prepare`, of one file: what is asked, and what became of it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "meshprep/budgets/quantize_budget.h"
#include "meshprep/budgets/time_certificate.h"
#include "meshprep/commands/batch_sources.h"
#include "meshprep/files/file_list.h"
#include "meshprep/files/input_file.h"
#include "meshprep/files/manifest.h"
#include "meshprep/files/output_directories.h"
#include "meshprep/options/camera_options.h"
#include "meshprep/options/common_options.h"
#include "meshprep/options/consumer_option.h"
#include "meshprep/output/console.h"
#include "meshprep/output/counts.h"
#include "meshprep/output/report_json.h"
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
    prep::Quantization quantization;
    bool choose_bits = false;  // of directions, by
    DirectionErrors direction_errors;
    std::optional<double> budget_ms;  // to prepare a file in: the precision or the level follows
    int jobs = 1;                     // files at once; 0: as many as there are cores
    std::filesystem::path manifest;
    bool skip_unchanged = false;
    Settings settings;  // what was given of what decides about the output
    prep::PrepareOptions prepare;
    ConsumerWish consumer;       // who reads the result
    CameraWishes camera;         // of the picture that pixel errors are meant in,
    prep::RenderWishes picture;  // and its size
};

// Of the whole process: with --jobs, of other files too.
struct MemoryUse {
    std::uint64_t page_faults = 0;  // while the step ran
    std::uint64_t peak_bytes = 0;   // from the process' start to the step's end
};

// What became of one file.
struct Outcome {
    Job job;
    std::optional<prep::Error> error;
    bool skipped = false;  // an earlier run's output is what this one's would be
    std::vector<HashedFile> sources;
    std::set<std::string> absent;  // files that would be read in place of some of them
    std::vector<std::filesystem::path> written;
    bool complete = true;  // all that the input names was found
    std::string bytes;     // for standard output
    Counts before, after, gltf_before, gltf_after;
    Counts parts;  // of a scene that is no glTF file: skins, animations, …
    prep::Placement placement;
    prep::SplitCounts splits;
    std::vector<prep::StageReport> stages;
    Json requirements;  // by mesh, where they are to be explained
    std::vector<prep::Finding> findings;
    std::vector<prep::RepairStep> repairs;
    std::vector<std::optional<prep::TessellationCertificate>> tessellated;  // by mesh
    std::vector<std::optional<prep::OrderChange>> orders;                   // by mesh
    std::vector<prep::ResidualMap> residual_maps;
    std::vector<std::string> residual_names;  // of their materials
    std::vector<std::string> mesh_names;
    std::vector<std::string> warnings, remarks, notes;
    std::optional<prep::QuantizationReport> quantized;
    std::optional<QuantizationCertificate> certificate;
    std::optional<TimeCertificate> times;
    double read_ms = 0, prepare_ms = 0, write_ms = 0;
    MemoryUse read_memory, prepare_memory, write_memory;
    std::uint64_t bytes_before = 0, bytes_after = 0;  // of all files read, and written

    std::size_t warning_count() const;
    // Whether all is as exact and as fast as was asked.
    bool met() const { return (!certificate || certificate->met()) && (!times || times->met); }
};

// What the files of one command line share.
struct BatchSurroundings {
    OutputDirectories& directories;
    SiblingLinks& links;
    BatchSources& sources;
    Console& console;
};

// Reads, prepares and writes one file, a job of those of the batch's sources; `prefix` begins what
// is shown of its progress. Whatever goes wrong is the outcome's error.
Outcome prepare_file(const Job& job, const PrepareCommand& command, int threads,
                     const BatchSurroundings& batch, const std::string& prefix);

}  // namespace meshprep
