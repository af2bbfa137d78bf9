// SPDX-License-Identifier: Apache-2.0
#include "tests/server/procedures/written_procedure.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/temporary_folder.hpp"

#include <fstream>

namespace server_procedures_procedure_command_test {

using aeolis::test::program;

namespace {

/// `aeolis procedure …`, in the folder.
aeolis::test::Ended procedure(const std::filesystem::path& folder, const std::string& arguments) {
    return aeolis::test::run(program(), "procedure " + arguments, folder);
}

}  // namespace

TEST_CASE("the program checks procedures and ends with 0, with 1 when one breaks a rule, with 2 when one is not there",
          "[procedures][cli]") {
    if (program().empty()) return;
    const aeolis::test::TemporaryFolder folder;
    aeolis::tests::WrittenProcedure written;
    written.watchdogs =
        "watchdogs:\n  - {watchdog: w, when: [{event: EDL_BEGUN, since: run}], who: gnc, do: W, begin: q}\n";
    std::ofstream{folder / "p.yaml"} << written.text();

    const auto alone = procedure(folder.path(), "check p.yaml");
    CHECK(alone.code == 1);
    CHECK(alone.text == "p.yaml:13:83: 'q' is no procedure beside this one; the nearest name is 'p'\n");

    std::ofstream{folder / "q.yaml"} << "procedure: q\n";
    const auto both = procedure(folder.path(), "check p.yaml q.yaml");
    CHECK(both.code == 1);
    CHECK_THAT(both.text,
               Catch::Contains("p.yaml: no rule is broken: revision 1, a draft, 0 preconditions, 1 step, 1 watchdog, 1 "
                               "confirmation\n") &&
                   Catch::Contains("q.yaml:1:1: a procedure lacks 'title'\n"));
    CHECK(procedure(folder.path(), "check p.yaml").code == 0);

    const auto json = procedure(folder.path(), "check --json p.yaml");
    CHECK(json.code == 0);
    CHECK(json.text == "{\"procedures\":[{\"file\":\"p.yaml\",\"procedure\":\"p\",\"revision\":1,\"approved\":false,"
                       "\"steps\":2,\"watchdogs\":1,\"findings\":[]}]}\n");
    const auto faults = procedure(folder.path(), "check --json q.yaml");
    CHECK(faults.code == 1);
    CHECK_THAT(faults.text,
               Catch::StartsWith("{\"procedures\":[{\"file\":\"q.yaml\",\"findings\":[{\"line\":1,\"column\":"
                                 "1,\"message\":\"a procedure lacks 'title'\"},"));

    const auto missing = procedure(folder.path(), "check r.yaml");
    CHECK(missing.code == 2);
    CHECK(missing.text == "aeolis: procedure check: r.yaml: cannot be read\n");
    CHECK(procedure(folder.path(), "check --nonsense").code == 2);
}

TEST_CASE("the program prints a procedure, and not one that breaks a rule", "[procedures][cli]") {
    if (program().empty()) return;
    const aeolis::test::TemporaryFolder folder;
    std::ofstream{folder / "p.yaml"} << aeolis::tests::WrittenProcedure{}.text();
    std::ofstream{folder / "q.yaml"} << "procedure: q\n";
    const auto page = procedure(folder.path(), "print p.yaml");
    CHECK(page.code == 0);
    CHECK_THAT(page.text, Catch::StartsWith("T\n====") && Catch::Contains("[ ]   a, gnc\n      A\n"));
    const auto broken = procedure(folder.path(), "print q.yaml");
    CHECK(broken.code == 1);
    CHECK_THAT(broken.text, Catch::StartsWith("q.yaml:1:1: a procedure lacks 'title'\n"));
    CHECK(procedure(folder.path(), "print").code == 2);
}

}  // namespace server_procedures_procedure_command_test
