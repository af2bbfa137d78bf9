// SPDX-License-Identifier: Apache-2.0
#include "server/net/console_backend.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"
#include "tests/support/temporary_folder.hpp"

#include <fstream>

namespace server_console_backend_test {

using namespace aeolis;
using namespace aeolis::server;

TEST_CASE("a server that does not come up makes no account: the one that does tells the first password", "[access]") {
    test::TemporaryFolder folder;
    ConsoleBackend::Settings settings;
    settings.accounts = folder / "accounts.json";
    settings.archive = folder / "no_archive";
    settings.web = settings.scenarios = folder / "";
    std::ofstream{settings.archive} << "not an archive";
    CHECK_FALSE(ConsoleBackend::open(settings, tests::shipped_dictionary()));
    CHECK_FALSE(std::filesystem::exists(settings.accounts));
    settings.archive = folder / "a.db";
    const auto backend = ConsoleBackend::open(settings, tests::shipped_dictionary());
    REQUIRE(backend);
    CHECK_FALSE((*backend)->first_password().empty());
}

}  // namespace server_console_backend_test
