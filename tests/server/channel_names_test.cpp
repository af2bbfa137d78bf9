// SPDX-License-Identifier: Apache-2.0
#include "server/api/channel_names.hpp"

#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

namespace server_channel_names_test {

using namespace aeolis;

TEST_CASE("a channel is found by name or alias, and an unknown name is refused with its field and the nearest one",
          "[api][R62]") {
    const auto& dictionary = tests::shipped_dictionary();
    const auto& some = dictionary.channels.at(7);
    CHECK(server::channel_named(dictionary, "names", some.name).value() == &some);
    CHECK(server::channel_named(dictionary, "names", some.alias).value() == &some);
    CHECK(server::channel_named(dictionary, "names", "altitud_m").error().message ==
          "names: there is no channel 'altitud_m'; the nearest name is 'altitude_m'");
}

}  // namespace server_channel_names_test
