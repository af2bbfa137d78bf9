#include "tests/structure/source_tree.hpp"
#include "tests/support/catch.hpp"

using namespace aeolis::structure;

namespace {

bool some_line(const std::string& file, std::initializer_list<const char*> words) {
    for (const std::string& line : lines_of(file)) {
        bool all = !line.starts_with("#");
        for (const char* word : words) all = all && line.find(word) != std::string::npos;
        if (all) return true;
    }
    return false;
}

} // namespace

TEST_CASE("static analysis, sanitizers and the memory checker are part of the checks, and reviews are recorded",
          "[structure][R37]") {
    CHECK(some_line(".ci/run", {"if ! xargs", "clang-tidy-19"}));
    CHECK(some_line(".ci/run", {"flight", "status=1"}));
    CHECK(some_line(".ci/run", {"cppcheck", "--enable"}));
    CHECK(some_line("test", {"valgrind", "--error-exitcode"}));
    CHECK(some_line("CMakePresets.json", {"-fsanitize=address,undefined", "-fno-sanitize-recover=all"}));
    CHECK(some_line("CMakePresets.json", {"-fsanitize=thread"}));
    CHECK(some_line("test", {"build_target", "dev"}));
    CHECK(files_under("docs/reviews", {".md"}).size() >= 2);  // one beside the README
}
