// SPDX-License-Identifier: Apache-2.0
// docs/programs.md: 503 says in Retry-After how long to wait. One answer has none, since its request was taken.
#include "tests/structure/source_tree.hpp"
#include "tests/support/catch.hpp"

#include <regex>
#include <string>
#include <vector>

namespace structure_retry_after_test {

using namespace aeolis::structure;

TEST_CASE("503 is answered with a time after which to ask again, unless the request was taken",
          "[structure][http][R62]") {
    const std::regex bare{
        R"((error_response|error_reply)\((\w+, )?(503|http::status::service_unavailable)|[ (=][{] *503,)"};
    std::vector<std::string> without;
    for (const auto& file : files_under("server", {".hpp", ".cpp"})) {
        for (const auto& line : lines_of(file))
            if (std::regex_search(line, bare) && line.find("Retry-After") == std::string::npos)
                without.push_back(file + ": " + line.substr(line.find_first_not_of(' ')));
    }
    CHECK(without ==
          std::vector<std::string>{"server/api/annotation_routes.cpp: if (!annotated->not_stored_yet.empty()) "
                                   "return respond(error_response(503, annotated->not_stored_yet));",
                                   "server/api/procedure_routes.cpp: if (!done->not_stored_yet.empty()) "
                                   "return respond(error_response(503, done->not_stored_yet));"});
}

}  // namespace structure_retry_after_test
