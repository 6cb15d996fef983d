// One self-contained HTML page: pictures inside as data: URIs, no script, nothing from elsewhere,
// light and dark by the reader's preference.
#pragma once

#include <string>
#include <vector>

#include "prep/result.h"
#include "sheets/sheet.h"

namespace report {

struct Table {
    std::string title;
    std::vector<std::string> head;
    std::vector<std::vector<std::string>> rows;
};

struct Page {
    std::string title, subtitle;
    std::vector<Sheet> sheets;
    std::vector<Table> tables;  // stages, findings, …
    bool tables_first = false;  // before the sheets
};

// Errors: those of encode_png. The same page gives the same bytes.
prep::Result<std::string> html_page(const Page& page);

std::string base64(const std::vector<std::byte>& bytes);
std::string html_escaped(const std::string& text);  // also replaces what is not UTF-8

}  // namespace report
