// SPDX-License-Identifier: Apache-2.0
#include "tests/structure/source_tree.hpp"
#include "tests/support/catch.hpp"

#include <regex>

namespace structure_documents_test {

using namespace aeolis::structure;

namespace {

namespace fs = std::filesystem;

bool is_in_repository(const fs::path& path) {
    return fs::exists(fs::path{AEOLIS_SOURCE_DIR} / path);
}

std::vector<std::string> linking_pages() {
    auto all = files_under("docs", {".md"});
    all.insert(all.end(), {"README.md", "CONTRIBUTING.md", "CHANGELOG.md", "SECURITY.md", "bench/README.md",
                           "web/README.md", "web/openmct/README.md"});
    return all;
}

std::vector<std::string> groups_of(const std::string& text, const std::regex& pattern) {
    std::vector<std::string> found;
    for (std::sregex_iterator it{text.begin(), text.end(), pattern}, end; it != end; ++it) found.push_back((*it)[1]);
    return found;
}

}  // namespace

TEST_CASE("every page links to files that exist", "[structure]") {
    static const std::regex link{R"(\]\(([^)#\s]+)[^)]*\))"};
    std::string dead;
    for (const std::string& page : linking_pages())
        for (const std::string& target : groups_of(text_of(page), link))
            if (target.find("://") == std::string::npos && !is_in_repository(fs::path{page}.parent_path() / target))
                dead += page + ": " + target + "\n";
    INFO(dead);
    CHECK(dead.empty());
}

TEST_CASE("the files and folders that the front pages and the glossary name exist", "[structure]") {
    static const std::regex path{
        R"(`((?:common|schema|dictionaries|flight|simulation|telemetry|commands|server|web|tests|bench|docs|setup)/[\w./-]*)`)"};
    std::string missing;
    for (const std::string page : {"README.md", "CONTRIBUTING.md", "SECURITY.md", "docs/glossary.md"})
        for (const std::string& name : groups_of(text_of(page), path))
            if (!name.starts_with("web/dist") && !name.starts_with("web/node_modules") && !is_in_repository(name))
                missing += page + ": " + name + "\n";
    INFO(missing);
    CHECK(missing.empty());
}

}  // namespace structure_documents_test
