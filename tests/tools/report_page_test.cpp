// The validation page as a text: what is escaped, what stands where, and pictures as bytes.
#include <gtest/gtest.h>

#include <set>

#include "command_runner.h"
#include "sheets/page.h"

namespace {

using test::TempDir;

// What a reader of the page sees between the tags, and the tags themselves. Fails on what HTML does
// not allow there: a `<` that starts no tag of ours, a `&` that starts no entity.
struct Reading {
    std::string text;               // entities resolved, tags replaced by line breaks
    std::vector<std::string> tags;  // as they stand
    std::vector<std::string> errors;
};

std::string resolved(const std::string& text, std::vector<std::string>& errors) {
    const std::pair<const char*, const char*> entities[] = {
        {"&amp;", "&"}, {"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}};
    std::string out;
    for (std::size_t i = 0; i < text.size();) {
        bool found = false;
        if (text[i] == '&') {
            for (const auto& [name, character] : entities) {
                if (text.compare(i, std::string(name).size(), name) != 0) continue;
                out += character;
                i += std::string(name).size();
                found = true;
                break;
            }
            if (!found) errors.push_back("& at: " + text.substr(i, 20));
        }
        if (!found) out += text[i++];
    }
    return out;
}

Reading read(const std::string& page) {
    static const std::set<std::string> known = {
        "!DOCTYPE", "html",       "head",   "meta",  "title",   "style", "body",   "main",
        "h1",       "h2",         "h3",     "p",     "section", "div",   "figure", "img",
        "span",     "figcaption", "strong", "ul",    "li",      "i",     "dl",     "dt",
        "dd",       "table",      "thead",  "tbody", "tr",      "th",    "td",     "footer"};
    Reading out;
    std::string words;
    for (std::size_t i = 0; i < page.size();) {
        if (page[i] != '<') {
            words += page[i++];
            continue;
        }
        // Attributes are quoted; a > within the quotes ends nothing.
        std::size_t end = i + 1;
        for (bool quoted = false; end < page.size() && (quoted || page[end] != '>'); ++end)
            if (page[end] == '"') quoted = !quoted;
        const std::string tag = page.substr(i + 1, end - i - 1);
        const std::string name = tag.substr(tag[0] == '/' ? 1 : 0)
                                     .substr(0, tag.find_first_of(" \n") - (tag[0] == '/' ? 1 : 0));
        if (known.count(name) == 0) out.errors.push_back("<" + tag.substr(0, 30));
        out.tags.push_back(tag);
        out.text += resolved(words, out.errors) + "\n";
        words.clear();
        i = end + 1;
        if (name == "style" && tag[0] != '/') i = page.find("</style>", i);  // no text
    }
    return out;
}

TEST(HtmlEscape, LeavesNoCharacterThatMeansSomethingToHtml) {
    EXPECT_EQ(report::html_escaped("a<b>&\"c\" 'd'"), "a&lt;b&gt;&amp;&quot;c&quot; 'd'");
    EXPECT_EQ(report::html_escaped("&lt;"), "&amp;lt;");
    EXPECT_EQ(report::html_escaped("één → 90°\tx\ny"), "één → 90°\tx\ny");
    EXPECT_EQ(report::html_escaped(""), "");
    const std::string none = "\xEF\xBF\xBD";  // U+FFFD
    EXPECT_EQ(report::html_escaped(std::string("a\0b\x01", 4)), "a" + none + "b" + none);
    EXPECT_EQ(report::html_escaped("\xff<\xc3"), none + "&lt;" + none);
    EXPECT_EQ(report::html_escaped("\xc3(\xe2\x82"), none + "(" + none + none);
    EXPECT_EQ(report::html_escaped("\xc0\xaf"), none + none);  // a / in two bytes is none
    EXPECT_EQ(report::html_escaped("\xf0\x9f\x98\x80"), "\xf0\x9f\x98\x80");
}

std::vector<std::byte> bytes_of(const std::string& text) {
    std::vector<std::byte> bytes;
    for (const char c : text) bytes.push_back(std::byte(static_cast<unsigned char>(c)));
    return bytes;
}

// RFC 4648, section 10; and every digit.
TEST(Base64, IsThatOfTheStandard) {
    const std::pair<const char*, const char*> vectors[] = {{"", ""},
                                                           {"f", "Zg=="},
                                                           {"fo", "Zm8="},
                                                           {"foo", "Zm9v"},
                                                           {"foob", "Zm9vYg=="},
                                                           {"fooba", "Zm9vYmE="},
                                                           {"foobar", "Zm9vYmFy"}};
    for (const auto& [text, coded] : vectors) EXPECT_EQ(report::base64(bytes_of(text)), coded);
    std::string all;
    for (int i = 0; i < 256; ++i) all += char(i);
    EXPECT_EQ(report::base64(bytes_of(all)), test::base64_of(all));
    EXPECT_EQ(report::base64(bytes_of("\xff\xef\xfe")), "/+/+");
}

const std::string hostile = R"(</strong><script>alert("1")</script> & 'x')";

report::Page hostile_page() {
    report::Page page;
    page.title = "title " + hostile;
    page.subtitle = "subtitle " + hostile;
    for (int s = 0; s < 2; ++s) {
        report::Sheet sheet;
        sheet.title = "sheet " + hostile;
        sheet.subtitle = "sheet's subtitle " + hostile;
        sheet.footer = "footer " + std::to_string(s) + hostile;
        report::Panel drawn;
        drawn.id = "flat";
        drawn.title = "panel " + hostile;
        drawn.caption = "caption " + hostile;
        drawn.alt = "alt " + hostile;
        drawn.picture = prep::Image{1, 1, 4, {1, 0, 0, 1}, true};
        drawn.legend = {{report::rgb(0x0a80ff), "legend " + hostile}};
        report::Panel noted;
        noted.id = "id" + hostile;
        noted.note = "note " + hostile;
        sheet.panels = {drawn, noted};
        sheet.groups = {{"group " + hostile,
                         {{"name " + hostile, "value " + hostile, s == 1}, {"n", "v", false}}}};
        page.sheets.push_back(sheet);
    }
    page.tables = {{"table " + hostile, {"head " + hostile}, {{"cell " + hostile}, {"last"}}}};
    return page;
}

TEST(HtmlPage, NothingThatIsSaidBecomesMarkup) {
    const auto html = report::html_page(hostile_page());
    ASSERT_TRUE(html);
    const Reading reading = read(*html);
    EXPECT_EQ(reading.errors, std::vector<std::string>{});
    // All of it is there to read, as it was said.
    for (const char* what :
         {"title ", "subtitle ", "sheet ", "sheet's subtitle ", "footer 0", "panel ", "caption ",
          "legend ", "note ", "group ", "name ", "value ", "table ", "head ", "cell "}) {
        std::string said = what;
        said += hostile;
        EXPECT_NE(reading.text.find("\n" + said + "\n"), std::string::npos) << what;
    }
}

TEST(HtmlPage, PutsEverythingWhereItBelongs) {
    report::Page page = hostile_page();
    page.sheets.pop_back();
    const std::string one = *report::html_page(page);
    EXPECT_EQ(read(one).text.find("\nsheet "), std::string::npos);  // the page's title says it
    EXPECT_NE(one.find("<dd>v</dd>"), std::string::npos);
    EXPECT_EQ(one.find("<dd class=\"attention\">"), std::string::npos);
    EXPECT_NE(one.find("<i style=\"background:#0a80ff\"></i>"), std::string::npos);
    EXPECT_NE(one.find("<figure id=\"sheet1-flat\">"), std::string::npos);
    EXPECT_NE(one.find("<tr><td>last</td></tr>"), std::string::npos);
    const std::string two = *report::html_page(hostile_page());
    EXPECT_NE(two.find("<dd class=\"attention\">value "), std::string::npos);
    EXPECT_NE(two.find("<figure id=\"sheet2-flat\">"), std::string::npos);
    EXPECT_EQ(two.find("footer 1"), std::string::npos);
    // The picture is a PNG of one red pixel.
    const std::string mark = "<img width=\"1\" height=\"1\" alt=\"";
    ASSERT_NE(one.find(mark), std::string::npos);
    const std::string src = "src=\"data:image/png;base64,";
    const std::size_t begin = one.find(src) + src.size();
    const auto png = prep::encode_png({1, 1, 4, {1, 0, 0, 1}, true});
    ASSERT_TRUE(png);
    const std::string bytes(reinterpret_cast<const char*>(png->data()), png->size());
    EXPECT_EQ(bytes.substr(1, 3), "PNG");
    EXPECT_EQ(one.substr(begin, one.find('"', begin) - begin), test::base64_of(bytes));
    EXPECT_EQ(*report::html_page(hostile_page()), two);
}

// Names of files, meshes and materials come from whoever made the file.
TEST(Validate, NamesOfTheFileAreTextOnThePage) {
    const TempDir dir;
    const std::string file = "a&b <i>\"q\"", mesh = "<script>\"m\"&", material = "\"><b>&amp;";
    test::GltfText gltf;
    // NaN is nothing that JSON knows; a vertex that nothing uses is worth a finding.
    gltf.add({mesh,
              {0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5},
              {},
              {0, 0, 1, 0, 0, 1, 1, 1},
              {},
              {0, 1, 2},
              "\"material\":0",
              ""});
    gltf.add({"", {0, 0, 0, 1, 0, 0, 0, 1, 0}, {}, {}, {}, {0, 1, 2}, "", ""});
    test::write_text(dir / (file + ".gltf"),
                     gltf.text(R"("materials":[{"name":)" + test::json_quoted(material) +
                               R"(,"normalTexture":{"index":0}}],"textures":[{"source":0}],)"
                               R"("images":[{"uri":"none.png","name":"n"}])"));
    const test::Ran ran = test::run_here({"validate", (dir / (file + ".gltf")).string(), "-o",
                                          (dir / "out").string(), "--panel", "64", "--json"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const std::string page = test::file_text(dir / "out" / (file + ".html"));
    const Reading reading = read(page);
    EXPECT_EQ(reading.errors, std::vector<std::string>{});
    for (const std::string& tag : reading.tags) {
        EXPECT_NE(tag, "b");
        EXPECT_NE(tag, "i");
        EXPECT_NE(tag.substr(0, 6), "script");
    }
    EXPECT_NE(reading.text.find("\n" + file + ".gltf\n"), std::string::npos);  // title
    EXPECT_NE(reading.text.find("· mesh '" + mesh + "'\n"), std::string::npos);
    EXPECT_NE(reading.text.find("· mesh 1\n"), std::string::npos);        // without a name
    EXPECT_NE(reading.text.find("\n" + mesh + "\n"), std::string::npos);  // in the findings' table
    EXPECT_NE(reading.text.find("material '" + material + "' has a tangent-space normal map"),
              std::string::npos)
        << reading.text;
    // Of pictures' names, the file's part is as it was; the mesh's keeps to what every file system
    // takes.
    const nlohmann::json sheets = ran.json()["files"][0]["sheets"];
    ASSERT_EQ(sheets.size(), 3u);
    EXPECT_EQ(std::filesystem::path(sheets[0].get<std::string>()).filename(), file + ".png");
    EXPECT_EQ(std::filesystem::path(sheets[1].get<std::string>()).filename(),
              file + "-0-script-m.png");
    EXPECT_EQ(std::filesystem::path(sheets[2].get<std::string>()).filename(), file + "-1.png");
}

}  // namespace
