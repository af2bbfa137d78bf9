// SPDX-License-Identifier: Apache-2.0
#include "telemetry/product_assembler.hpp"

#include "common/crc.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <random>

namespace telemetry_product_assembler_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

std::vector<std::uint8_t> some_content(std::size_t octets) {
    std::vector<std::uint8_t> content(octets);
    for (std::size_t i = 0; i < octets; ++i) content[i] = static_cast<std::uint8_t>(i * 7 + i / 256);
    return content;
}

/// The parts of a product as flight cuts them, 100 octets each.
std::vector<ProductPart> parts_of(const std::vector<std::uint8_t>& content, std::uint16_t id = 1) {
    constexpr std::size_t part_octets = 100;
    const auto parts = static_cast<std::uint16_t>((content.size() + part_octets - 1) / part_octets);
    std::vector<ProductPart> all;
    for (std::uint16_t i = 0; i < parts; ++i) {
        const auto begin = content.begin() + i * static_cast<std::ptrdiff_t>(part_octets);
        const auto size = std::min(part_octets, content.size() - i * part_octets);
        all.push_back({{id, crc16(content), static_cast<std::uint32_t>(content.size())},
                       "imu_burst",
                       Apid{0x035},
                       static_cast<std::uint16_t>(i + 1),
                       parts,
                       {begin, begin + static_cast<std::ptrdiff_t>(size)}});
    }
    return all;
}

const std::pair<const ProductIdentity, Product>& only(const ProductAssembler& assembler) {
    REQUIRE(assembler.products().size() == 1);
    return *assembler.products().begin();
}

}  // namespace

TEST_CASE("a product is put together from parts in any order, with repeats", "[products][R30]") {
    const auto content = some_content(1234);
    for (unsigned seed = 0; seed < 20; ++seed) {
        auto parts = parts_of(content);
        const std::vector<ProductPart> repeated(parts.begin(), parts.begin() + 5);
        parts.insert(parts.end(), repeated.begin(), repeated.end());
        std::ranges::shuffle(parts, std::mt19937{seed});
        ProductAssembler assembler;
        int again = 0;
        for (const auto& part : parts) again += assembler.add(part) == PartStanding::again;
        CHECK(again == 5);
        const auto& [identity, product] = only(assembler);
        CHECK(product.content(identity) == content);
        CHECK(product.gaps().empty());
        CHECK(text_of(identity, product) == "imu_burst 1, 1234 octets: whole");
    }
}

TEST_CASE("what is missing of a product is named, and it has no content until it is whole", "[products][R30]") {
    const auto parts = parts_of(some_content(1234));
    ProductAssembler assembler;
    for (const std::size_t part : {1U, 2U, 6U, 8U, 13U}) CHECK(assembler.add(parts[part - 1]) == PartStanding::taken);
    const auto& [identity, product] = only(assembler);
    CHECK_FALSE(product.content(identity));
    CHECK(product.gaps() == "3-5, 7, 9-12");
    CHECK(text_of(identity, product) == "imu_burst 1, 1234 octets: parts 3-5, 7, 9-12 of 13 are missing");
}

TEST_CASE("a part that contradicts one before is not taken, and a wrong whole is found by its CRC", "[products][R30]") {
    auto parts = parts_of(some_content(250));
    ProductAssembler assembler;
    CHECK(assembler.add(parts[0]) == PartStanding::taken);
    parts[0].content[3] ^= 1U;
    CHECK(assembler.add(parts[0]) == PartStanding::differs);
    parts[1].kind = "as_flown";
    CHECK(assembler.add(parts[1]) == PartStanding::differs);
    parts[1].kind = "imu_burst";
    parts[1].content[0] ^= 1U;
    CHECK(assembler.add(parts[1]) == PartStanding::taken);
    CHECK(assembler.add(parts[2]) == PartStanding::taken);
    const auto& [identity, product] = only(assembler);
    CHECK_FALSE(product.content(identity));
    CHECK(text_of(identity, product) == "imu_burst 1, 250 octets: all parts are here, but their CRC is wrong");
}

TEST_CASE("products of two computers with the same number stay apart", "[products][R30]") {
    ProductAssembler assembler;
    for (const auto& part : parts_of(some_content(250))) CHECK(assembler.add(part) == PartStanding::taken);
    for (const auto& part : parts_of(some_content(251))) CHECK(assembler.add(part) == PartStanding::taken);
    CHECK(assembler.products().size() == 2);
    for (const auto& [identity, product] : assembler.products()) CHECK(product.content(identity));
}

TEST_CASE("an assembler takes no more than its memory", "[products][R30]") {
    ProductAssembler assembler{450};
    const auto parts = parts_of(some_content(300));
    CHECK(assembler.add(parts[0]) == PartStanding::taken);
    CHECK(assembler.add(parts[1]) == PartStanding::taken);
    CHECK(assembler.add(parts[2]) == PartStanding::refused);
    CHECK(assembler.add(parts_of(some_content(301), 2)[0]) == PartStanding::refused);
    CHECK(only(assembler).second.gaps() == "3");
}

TEST_CASE("a packet that is no part of a product, or contradicts itself, is none", "[products][R30]") {
    const auto& dictionary = tests::shipped_dictionary();
    const Decommutator decommutator{dictionary};
    const dictionary::Packet& container = *dictionary.packet("DataProduct");
    const auto read = [&](std::uint16_t part, std::uint16_t parts, std::uint32_t octets) {
        std::vector<std::uint8_t> packet(container.octets);
        const auto put = [&](std::string_view name, std::uint64_t value) {
            const auto& field = container.fields[*field_index(container, name)];
            for (unsigned bit = 0; bit < field.type.bits; ++bit) {
                const unsigned at = field.position_bits + bit;
                if ((value >> (field.type.bits - 1 - bit)) & 1U)
                    packet[at / 8] = static_cast<std::uint8_t>(packet[at / 8] | 1U << (7 - at % 8));
            }
        };
        put("part", part);
        put("parts", parts);
        put("product_octets", octets);
        seal_tm_packet(packet, container.apid, 0, {}, dictionary.id);
        Decoded decoded;
        REQUIRE_FALSE(decommutator.decode(packet, decoded));
        return part_of(dictionary, decoded, packet);
    };
    const std::uint32_t full = container.content->octets;
    const auto last = read(2, 2, full + 3);
    REQUIRE(last);
    CHECK(last->content.size() == 3);
    CHECK(last->kind == "as_flown");
    CHECK(read(1, 2, full + 3)->content.size() == full);
    CHECK_FALSE(read(0, 2, full + 3));
    CHECK_FALSE(read(3, 2, full + 3));
    CHECK_FALSE(read(1, 1, full + 3));
    CHECK_FALSE(read(1, 0, 0));
    CHECK_FALSE(read(1, 65535, 0xFFFFFFFF));

    Decoded other;
    std::vector<std::uint8_t> status(dictionary.packet("CommStatus")->octets);
    seal_tm_packet(status, dictionary.packet("CommStatus")->apid, 0, {}, dictionary.id);
    REQUIRE_FALSE(decommutator.decode(status, other));
    CHECK_FALSE(part_of(dictionary, other, status));
}

TEST_CASE("the rows of a product are read by the container that it names", "[products][R30][R48]") {
    const auto& dictionary = tests::shipped_dictionary();
    const dictionary::Packet& container = *dictionary.packet("TimepointFired");
    const std::size_t row_octets = container.octets - tm_overhead_octets;
    std::vector<std::uint8_t> content(2 * row_octets);
    content[row_octets + 1] = 7;  // timepoint of the second row
    const auto rows = rows_of(dictionary, container.apid, content);
    REQUIRE(rows);
    REQUIRE(rows->size() == 2);
    Decoded decoded;
    REQUIRE_FALSE(Decommutator{dictionary}.decode((*rows)[1], decoded));
    CHECK(decoded.value[*field_index(container, "timepoint")] == 7.0);
    content.pop_back();
    CHECK_FALSE(rows_of(dictionary, container.apid, content));
    CHECK_FALSE(rows_of(dictionary, Apid{0x7FE}, content));
}

}  // namespace telemetry_product_assembler_test
