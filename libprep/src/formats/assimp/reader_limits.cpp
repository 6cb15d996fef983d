#include "formats/assimp/reader_limits.h"

#include <algorithm>

namespace prep::detail {

std::vector<std::string> misread_statements(std::string_view ending, std::string_view text) {
    struct Row {
        std::string_view ending;
        std::vector<std::string_view> words;  // any of them
        std::string_view sentence;
    };
    // Seen with files that have each of them and little else.
    static const std::vector<Row> rows{
        {".x3d", {"<IndexedLineSet"}, "Assimp reads the lines of IndexedLineSet as faces"},
        {".x3d",
         {"ccw=\"false\"", "ccw='false'"},
         "Assimp does not turn the faces of ccw=\"false\""},
        {".x3d",
         {"colorPerVertex=\"false\"", "colorPerVertex='false'", "colorIndex="},
         "Assimp gives colours of faces, or by colorIndex, to other corners than the file"},
        {".x3d", {"<LOD"}, "Assimp leaves out what LOD holds"},
        {".amf", {"<rx>", "<ry>", "<rz>"}, "Assimp reads rotations of instances as translations"},
    };
    std::vector<std::string> out;
    for (const Row& row : rows)
        if (row.ending == ending &&
            std::any_of(row.words.begin(), row.words.end(), [&](std::string_view word) {
                return text.find(word) != std::string_view::npos;
            }))
            out.emplace_back(row.sentence);
    return out;
}

}  // namespace prep::detail
