// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/state_diagram.hpp"
#include "tests/support/catch.hpp"

namespace dictionaries_state_diagram_test {

using namespace aeolis;

TEST_CASE("a state machine's diagram has its start and each of its transitions", "[dictionary][R48]") {
    dictionary::Dictionary dictionary;
    dictionary.state_machines = {
        {"Door", "shut", {{"shut", "pushed", "open", "", 2}, {"open", "pulled", "shut", "", 3}}}};
    CHECK(dictionary::autocoder::state_diagrams(dictionary) == "## Door\n\n"
                                                               "```mermaid\n"
                                                               "stateDiagram-v2\n"
                                                               "    [*] --> shut\n"
                                                               "    shut --> open: pushed\n"
                                                               "    open --> shut: pulled\n"
                                                               "```\n\n");
}

}  // namespace dictionaries_state_diagram_test
