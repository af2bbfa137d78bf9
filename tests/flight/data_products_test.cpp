// SPDX-License-Identifier: Apache-2.0
#include "flight/edl_comm/data_products.hpp"

#include "flight/kernel/parameter_parts.hpp"
#include "telemetry/product_assembler.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/outbox.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <cmath>
#include <random>

namespace flight_data_products_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

std::vector<std::uint8_t> copy(std::span<const std::uint8_t> octets) {
    return {octets.begin(), octets.end()};
}

ImuReadings reading(std::uint32_t count) {
    ImuReadings readings;
    readings.samples.push_back({count, {0.1 * count, 0.0, -1.0}, {0.0, 1e-3, 0.0}});
    return readings;
}

Record firing(std::uint16_t timepoint) {
    test::OutboxRecorder recorder;
    recorder.out.record(packet::TimepointFired{
        .timepoint = timepoint, .triggered_sclk = 100.0 + timepoint, .fired_sclk = 100.5 + timepoint});
    return recorder.sent<Record>().front();
}

/// The packet of a record, as EdlComm seals it.
std::vector<std::uint8_t> sealed(const Record& record) {
    std::vector<std::uint8_t> packet(record.size + tm_overhead_octets);
    std::copy_n(record.data.begin(), record.size, packet.begin() + tm_data_offset_octets);
    seal_tm_packet(packet, record.apid, 0, record.time, dictionary_id);
    return packet;
}

struct Ground {
    const dictionary::Dictionary& dictionary = tests::shipped_dictionary();
    telemetry::Decommutator decommutator{dictionary};
    telemetry::ProductAssembler assembler;

    telemetry::ProductPart part(const Record& record) {
        const auto packet = sealed(record);
        telemetry::Decoded decoded;
        REQUIRE_FALSE(decommutator.decode(packet, decoded));
        const auto part = telemetry::part_of(dictionary, decoded, packet);
        REQUIRE(part);
        return *part;
    }
};

/// Every part that is handed out, at most one a cycle.
std::vector<Record> all_parts(DataProducts& products) {
    std::vector<Record> parts;
    for (int cycle = 0; cycle < 500; ++cycle) {
        test::OutboxRecorder recorder{ModuleId::edl_comm};
        products.cycle(recorder.out);
        const auto sent = recorder.sent<Record>();
        REQUIRE(sent.size() <= 1);
        parts.insert(parts.end(), sent.begin(), sent.end());
    }
    return parts;
}

}  // namespace

TEST_CASE("the burst of the IMU keeps a second before the mortar and three after, in order", "[products][R30]") {
    ImuBurst burst;
    for (std::uint32_t count = 0; count < 555; ++count) burst.on(reading(count));
    burst.begin();
    CHECK_FALSE(burst.complete());
    for (std::uint32_t count = 555; count < 2000; ++count) burst.on(reading(count));
    REQUIRE(burst.complete());
    constexpr std::size_t row_octets = packet::ImuIncrements::octets - tm_overhead_octets;
    const auto content = burst.content();
    REQUIRE(content.size() == (ImuBurst::rows_before + ImuBurst::rows_after) * row_octets);
    for (std::size_t row = 0; row * row_octets < content.size(); ++row)
        REQUIRE(read_bits(content, row * row_octets * 8, 32) == 555 - ImuBurst::rows_before + row);
}

TEST_CASE("a mortar that fires early leaves a shorter burst, not an empty second", "[products][R30]") {
    ImuBurst burst;
    for (std::uint32_t count = 0; count < 10; ++count) burst.on(reading(count));
    burst.begin();
    for (std::uint32_t count = 10; count < 2000; ++count) burst.on(reading(count));
    REQUIRE(burst.complete());
    CHECK(read_bits(burst.content(), 0, 32) == 0);
    CHECK(burst.content().size() == (10 + ImuBurst::rows_after) * (packet::ImuIncrements::octets - tm_overhead_octets));
}

TEST_CASE("the ground puts a product together from its packets in any order, equal to what flight put in",
          "[products][R30]") {
    DataProducts products;
    ImuBurst same;
    for (std::uint32_t count = 0; count < 2000; ++count) {
        if (count == 700) {
            products.on(PhaseChanged{EdlPhase::wait_for_parachute});
            products.on(PhaseChanged{EdlPhase::parachute_descent});
            same.begin();
        }
        products.on(reading(count));
        same.on(reading(count));
    }
    auto parts = all_parts(products);
    CHECK(products.made() == 1);
    std::ranges::shuffle(parts, std::mt19937{7});
    Ground ground;
    for (const Record& part : parts) CHECK(ground.assembler.add(ground.part(part)) == telemetry::PartStanding::taken);
    REQUIRE(ground.assembler.products().size() == 1);
    const auto& [identity, product] = *ground.assembler.products().begin();
    CHECK(product.kind == "imu_burst");
    CHECK(product.content(identity) == copy(same.content()));
    const auto rows = telemetry::rows_of(ground.dictionary, product.row_apid, *product.content(identity));
    REQUIRE(rows);
    CHECK(rows->size() == ImuBurst::rows_before + ImuBurst::rows_after);
    telemetry::Decoded decoded;
    REQUIRE_FALSE(ground.decommutator.decode(rows->front(), decoded));
    CHECK(decoded.value[0] == 500.0);
    CHECK(decoded.value[1] == 50.0);  // delta_v_x_mps
}

TEST_CASE("a computer that takes over under the parachute makes no burst of a mortar that it did not see",
          "[products][R30]") {
    DataProducts products;
    products.on(PhaseChanged{EdlPhase::parachute_descent});
    for (std::uint32_t count = 0; count < 2000; ++count) products.on(reading(count));
    CHECK(all_parts(products).empty());
}

TEST_CASE("the table of parameters is dumped whole, bit for bit, and a newer table replaces one that is half sent",
          "[products][parameters][R25][R30][R48]") {
    DataProducts products;
    const auto dump = [&](const Parameters& parameters) {
        parameter_parts(parameters, [&](const ParameterPart& part) { products.on(part); });
    };
    Parameters first, second;
    first.guidance_gain = 4.0;
    second.guidance_gain = std::nextafter(4.0, 5.0);
    dump(first);
    test::OutboxRecorder recorder{ModuleId::edl_comm};
    products.cycle(recorder.out);
    Ground ground;
    for (const Record& part : recorder.sent<Record>()) ground.assembler.add(ground.part(part));
    dump(second);
    for (const Record& part : all_parts(products)) ground.assembler.add(ground.part(part));
    REQUIRE(ground.assembler.products().size() == 2);
    CHECK_FALSE(ground.assembler.products().begin()->second.content(ground.assembler.products().begin()->first));
    const auto& [identity, product] = *ground.assembler.products().rbegin();
    CHECK(product.kind == "parameter_table");
    const auto rows = telemetry::rows_of(ground.dictionary, product.row_apid, *product.content(identity));
    REQUIRE(rows);
    REQUIRE(rows->size() == parameter_count);
    for (std::uint16_t row = 0; row < parameter_count; ++row) {
        telemetry::Decoded decoded;
        REQUIRE_FALSE(ground.decommutator.decode((*rows)[row], decoded));
        CHECK(decoded.value[0] == row);
        CHECK(decoded.value[1] == value_of(second, ParameterId{row}));
    }
}

TEST_CASE("a part that is lost is named", "[products][R30]") {
    DataProducts products;
    for (std::uint16_t timepoint = 0; timepoint < 40; ++timepoint) products.on(firing(timepoint));
    products.on(PhaseChanged{EdlPhase::landed});
    const auto parts = all_parts(products);
    REQUIRE(parts.size() == 4);
    Ground ground;
    for (const std::size_t part : {0U, 3U}) ground.assembler.add(ground.part(parts[part]));
    const auto& [identity, product] = *ground.assembler.products().begin();
    CHECK(telemetry::text_of(identity, product) == "as_flown 1, 760 octets: parts 2-3 of 4 are missing");
}

TEST_CASE("what was flown is told at touchdown and once more when the timeline is complete", "[products][R30]") {
    DataProducts products;
    std::vector<std::uint8_t> flown;
    const auto fire = [&](std::uint16_t timepoint) {
        const Record record = firing(timepoint);
        products.on(record);
        flown.insert(flown.end(), record.data.begin(), record.data.begin() + record.size);
    };
    for (std::uint16_t timepoint = 0; timepoint + std::size_t{2} < timepoint_count; ++timepoint) fire(timepoint);
    products.on(PhaseChanged{EdlPhase::landed});
    const auto first = all_parts(products);
    const auto at_touchdown = flown;
    fire(timepoint_count - 2);
    CHECK(all_parts(products).empty());
    fire(timepoint_count - 1);
    const auto second = all_parts(products);
    Ground ground;
    for (const auto* parts : {&first, &second})
        for (const Record& part : *parts) ground.assembler.add(ground.part(part));
    REQUIRE(ground.assembler.products().size() == 2);
    for (const auto& [identity, product] : ground.assembler.products())
        CHECK(product.content(identity) == (identity.id == 1 ? at_touchdown : flown));
}

TEST_CASE("while a product is sent, rows that are added do not change it", "[products][R30]") {
    DataProducts products;
    for (std::uint16_t timepoint = 0; timepoint < 40; ++timepoint) products.on(firing(timepoint));
    products.on(PhaseChanged{EdlPhase::landed});
    Ground ground;
    for (std::uint16_t cycle = 0; cycle < 4; ++cycle) {
        test::OutboxRecorder recorder{ModuleId::edl_comm};
        products.cycle(recorder.out);
        ground.assembler.add(ground.part(recorder.sent<Record>().at(0)));
        products.on(firing(static_cast<std::uint16_t>(40 + cycle)));
    }
    const auto& [identity, product] = *ground.assembler.products().begin();
    CHECK(product.content(identity));
}

TEST_CASE("without a row there is no product", "[products][R30]") {
    DataProducts products;
    products.on(PhaseChanged{EdlPhase::landed});
    CHECK(all_parts(products).empty());
    CHECK(products.made() == 0);
}

}  // namespace flight_data_products_test
