// SPDX-License-Identifier: Apache-2.0
#include "server/archive/column_codec.hpp"
#include "tests/support/catch.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

namespace archive_column_codec_test {

using namespace aeolis;
using archive::ColumnCodec;

namespace {

using Column = std::vector<double>;
using Octets = std::vector<std::uint8_t>;

Octets packed(ColumnCodec& codec, const Column& column) {
    const auto octets = codec.pack(column);
    return {octets.begin(), octets.end()};
}

bool same_bits(const Column& a, const Column& b) {
    return std::ranges::equal(a, b, {}, std::bit_cast<std::uint64_t, double>, std::bit_cast<std::uint64_t, double>);
}

bool survives(const Column& column) {
    ColumnCodec codec;
    const auto octets = packed(codec, column);
    Column back(column.size(), -1.0);
    return codec.unpack(octets, back).ok() && same_bits(column, back);
}

template <typename Make>
Column column_of(std::size_t samples, Make make) {
    Column column(samples);
    for (std::size_t i = 0; i < samples; ++i) column[i] = make(i);
    return column;
}

}  // namespace

TEST_CASE("a packed column keeps every bit of its samples, whatever they are", "[archive][codec]") {
    std::mt19937_64 random(20);
    const auto samples = static_cast<std::size_t>(GENERATE(0, 1, 2, 3, 7, 1023, 1024));
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    const std::array odd{0.0,
                         -0.0,
                         nan,
                         -nan,
                         infinity,
                         -infinity,
                         std::bit_cast<double>(0x7FF0000000000001ULL),
                         std::bit_cast<double>(0xFFFFFFFFFFFFFFFFULL),
                         std::numeric_limits<double>::denorm_min(),
                         std::numeric_limits<double>::max(),
                         std::numeric_limits<double>::lowest(),
                         1.0};
    CHECK(survives(column_of(samples, [](std::size_t) { return 0.0; })));
    CHECK(survives(column_of(samples, [](std::size_t) { return -3.25; })));
    CHECK(survives(column_of(samples, [&](std::size_t) { return nan; })));
    CHECK(survives(column_of(samples, [&](std::size_t) { return odd[random() % odd.size()]; })));
    CHECK(survives(column_of(samples, [&](std::size_t i) { return odd[i % odd.size()]; })));
    CHECK(survives(column_of(samples, [&](std::size_t) { return std::bit_cast<double>(random()); })));
    CHECK(survives(column_of(samples, [](std::size_t i) { return static_cast<double>(i); })));
    CHECK(survives(column_of(samples, [](std::size_t i) { return 397'000'000.0 + static_cast<double>(i) / 64.0; })));
    CHECK(survives(column_of(samples, [](std::size_t i) { return -1e-3 * static_cast<double>(i); })));
    CHECK(survives(column_of(samples, [](std::size_t i) {
        return static_cast<double>(static_cast<float>(std::sin(static_cast<double>(i) * 1e-2)));
    })));
    CHECK(survives(column_of(samples, [](std::size_t i) { return i % 2 == 0 ? 1e300 : -1e-300; })));
    CHECK(survives(column_of(samples, [](std::size_t i) { return std::bit_cast<double>(1ULL << (i % 64)); })));
    // One bit somewhere in a column of zeros.
    CHECK(survives(column_of(
        samples, [&](std::size_t i) { return i == samples / 2 ? std::bit_cast<double>(1ULL << 63U) : 0.0; })));
}

TEST_CASE("columns of random shape keep every bit", "[archive][codec]") {
    std::mt19937_64 random(4711);
    for (int round = 0; round < 300; ++round) {
        Column column(random() % 1100);
        const std::uint64_t mask = ~0ULL << (random() % 64);  // as of numbers with few bits
        const auto jump = random() % 50;
        std::uint64_t word = random(), step = random() & mask;
        for (double& value : column) {
            value = std::bit_cast<double>(word);
            word += step;
            if (jump > 0 && random() % (jump + 1) == 0) step = (random() >> (random() % 64)) & mask;
        }
        INFO("round " << round << ", " << column.size() << " samples");
        REQUIRE(survives(column));
    }
}

TEST_CASE("a constant and a regular clock take some twenty octets, a smooth float under three a sample",
          "[archive][codec]") {
    ColumnCodec codec;
    CHECK(codec.pack(Column(1024, 42.5)).size() <= 16);
    CHECK(codec.pack(Column(1024, std::numeric_limits<double>::quiet_NaN())).size() <= 16);
    CHECK(codec.pack(column_of(1024, [](std::size_t i) { return 1000.0 + static_cast<double>(i) / 64.0; })).size() <=
          48);
    CHECK(codec
              .pack(column_of(1024,
                              [](std::size_t i) {
                                  return static_cast<double>(
                                      static_cast<float>(3000.0 * std::sin(static_cast<double>(i) * 1e-3)));
                              }))
              .size() < 3 * 1024);
}

TEST_CASE("any octet of a packed column that is changed, lost or added is found, and never read past",
          "[archive][codec]") {
    std::mt19937_64 random(7);
    ColumnCodec codec;
    const std::array columns{
        column_of(200, [&](std::size_t) { return std::bit_cast<double>(random()); }),
        column_of(
            200,
            [](std::size_t i) { return static_cast<double>(static_cast<float>(std::sin(static_cast<double>(i)))); }),
        column_of(200, [](std::size_t i) { return static_cast<double>(i) / 64.0; }), Column(200, 1.5)};
    for (const auto& column : columns) {
        const Octets good = packed(codec, column);
        Column back(column.size());
        for (std::size_t i = 0; i < good.size(); ++i) {
            for (unsigned bit = 0; bit < 8; ++bit) {
                Octets bad = good;
                bad[i] = static_cast<std::uint8_t>(bad[i] ^ (1U << bit));
                // zstd's own head has bits that mean nothing: then the samples are what they were.
                if (codec.unpack(bad, back).ok()) {
                    INFO("octet " << i << ", bit " << bit);
                    REQUIRE(same_bits(back, column));
                }
            }
            REQUIRE_FALSE(codec.unpack(std::span(good).first(i), back).ok());
        }
        Octets longer = good;
        longer.push_back(0);
        CHECK_FALSE(codec.unpack(longer, back).ok());
        for (const std::size_t wrong :
             {std::size_t{0}, std::size_t{1}, std::size_t{199}, std::size_t{201}, std::size_t{5000}}) {
            Column other(wrong);
            if (good[2] != 0) CHECK_FALSE(codec.unpack(good, other).ok());  // a constant knows no number
        }
    }
}

TEST_CASE("octets that were never a packed column are refused", "[archive][codec]") {
    std::mt19937_64 random(9);
    ColumnCodec codec;
    Column back(64);
    for (int round = 0; round < 3000; ++round) {
        Octets octets(random() % 64);
        for (auto& octet : octets) octet = static_cast<std::uint8_t>(random() % (round % 2 == 0 ? 3 : 256));
        const bool ok = codec.unpack(octets, back).ok();
        // A head of 16 bits of checksum may be met by chance; these seeds do not.
        REQUIRE_FALSE(ok);
    }
}

}  // namespace archive_column_codec_test
