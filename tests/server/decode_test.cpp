// SPDX-License-Identifier: Apache-2.0
// aeolis decode on what another mission's instrument sent, where those files are beside the project (../shared/data).
#include "dictionaries/xtce/packet_model.hpp"
#include "server/base/digest.hpp"
#include "telemetry/container_decoder.hpp"
#include "telemetry/packet_source.hpp"
#include "tests/support/catch.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace server_decode_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

const std::filesystem::path suda = AEOLIS_SOURCE_DIR "/../shared/data/packets/suda";

std::string file_text(const std::filesystem::path& path) {
    std::ifstream in{path, std::ios::binary};
    return {std::istreambuf_iterator<char>{in}, {}};
}

/// Octets are expected by their digest and number.
std::string expected_text(const Datum& datum) {
    const auto* octets = std::get_if<std::vector<std::uint8_t>>(&datum);
    if (octets == nullptr) return datum_text(datum);
    server::Digest digest;
    digest.add(*octets);
    return "sha256:" + digest.text() + ":" + std::to_string(octets->size());
}

}  // namespace

TEST_CASE("an instrument's packets decode by its own XTCE file to its published values", "[server][decode]") {
    if (!std::filesystem::exists(suda / "expected.csv")) {
        std::printf("SKIPPED: the instrument's packets are not beside the project (../shared/data)\n");
        return;
    }
    std::vector<dictionary::Finding> findings;
    dictionary::Findings into{"suda.xml", findings};
    const auto model =
        dictionary::xtce::read_packet_model(file_text(suda / "suda_combined_science_definition.xml"), into);
    REQUIRE(model);
    CHECK(findings.empty());
    const ContainerDecoder decoder{*model};
    PacketSource source = PacketSource::of_packets(4);
    const std::string stream = file_text(suda / "sciData_2022_130_17_41_53.spl");
    source.receive(std::vector<std::uint8_t>{stream.begin(), stream.end()});
    std::vector<std::string> rows;
    for (std::size_t index = 0; const auto packet = source.next(); ++index) {
        const auto contents = decoder.decode(*packet);
        CHECK(contents.problem.empty());
        REQUIRE(contents.time);  // SHCOARSE and SHFINE of the first packet: 389900330 and 31649
        if (index == 0) CHECK(contents.time->seconds == 389900330.0 + 31649.0 / 65536.0);
        for (const auto& value : contents.values)
            rows.push_back(std::to_string(index) + ",1425," + value.name + "," + expected_text(value.raw) + "," +
                           expected_text(value.calibrated));
    }
    std::istringstream expected{file_text(suda / "expected.csv")};
    std::string line;
    std::getline(expected, line);
    std::size_t row = 0;
    for (; std::getline(expected, line); ++row) {
        if (line.ends_with('\r')) line.pop_back();
        REQUIRE(row < rows.size());
        REQUIRE(rows[row] == line);
    }
    CHECK(row == rows.size());
}

}  // namespace server_decode_test
