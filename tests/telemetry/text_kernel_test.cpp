// SPDX-License-Identifier: Apache-2.0
#include "telemetry/text_kernel.hpp"
#include "tests/support/catch.hpp"

#include <random>

namespace telemetry_text_kernel_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

std::string data(const std::string& lines) {
    return "KPL/SCLK\nwords of people = not read\n\\begindata\n" + lines + "\n\\begintext\nmore = words\n";
}

std::string fault(const std::string& lines) {
    const auto kernel = TextKernel::parse(data(lines), "k.tsc");
    return kernel ? "" : kernel.error().message;
}

std::vector<double> values(const std::string& lines) {
    const auto kernel = TextKernel::parse(data(lines), "k.tsc");
    INFO((kernel ? "" : kernel.error().message));
    REQUIRE(kernel);
    const auto numbers = kernel->numbers("A", 1);
    REQUIRE(numbers);
    return *numbers;
}

}  // namespace

TEST_CASE("numbers are read as FORTRAN writes them, lists with commas or blanks, over several lines",
          "[telemetry][kernel]") {
    CHECK(values("A = 1.657D-3") == std::vector{1.657e-3});
    CHECK(values("A=( 1,2.5E+1 +3\n -.5d1 )") == std::vector{1.0, 25.0, 3.0, -5.0});
    CHECK(values("A = 1\nA += ( 2 3 )\nB = 9") == std::vector{1.0, 2.0, 3.0});
    CHECK(values("A = 1\nA = 2") == std::vector{2.0});
}

TEST_CASE("dates are seconds from noon of 2000-01-01 by the calendar", "[telemetry][kernel]") {
    CHECK(values("A = @2000-JAN-1") == std::vector{-43200.0});
    CHECK(values("A = @2000-JAN-1/12:00:01.5") == std::vector{1.5});
    CHECK(values("A = @01-JAN-1980-00:00:00.000") == std::vector{-631195200.0});
    CHECK(values("A = @1972-JAN-1") == std::vector{-883656000.0});  // naif0012 read by NAIF's library
    CHECK(values("A = @2012-08-06/05:17:57") == values("A = @2012-219T05:17:57"));
    CHECK(values("A = @1-OCT-2000") == values("A = @2000-10-01"));
}

TEST_CASE("texts stand in quotes, a quote in them twice; only data sections are read", "[telemetry][kernel]") {
    const auto kernel = TextKernel::parse(data("NAME = ( 'it''s' 'b' )"), "k");
    REQUIRE(kernel);
    REQUIRE(kernel->find("NAME") != nullptr);
    CHECK(kernel->find("NAME")->values == std::vector<TextKernel::Value>{"it's", "b"});
    CHECK(kernel->find("NAME")->line == 4);
    CHECK(kernel->find("more") == nullptr);
    CHECK_FALSE(kernel->numbers("NAME", 1));
}

TEST_CASE("what cannot be read is named with file and line", "[telemetry][kernel]") {
    CHECK(fault("A = 1\nB = ( 1 2") == "k.tsc:5: the ( of 'B' is never closed");
    CHECK(fault("A") == "k.tsc:4: there is no = behind 'A'");
    CHECK(fault("A = 1\n\nA = 1x") == "k.tsc:6: '1x' is neither a number, a date behind @ nor a text in quotes");
    CHECK(fault("A = @2000-13-01").starts_with("k.tsc:4: '@2000-13-01' is neither"));
    CHECK(fault("A = 'open") == "k.tsc:4: a text that begins with ' does not end in its line");
    CHECK(fault("A = ()") == "k.tsc:4: 'A' has no value");
    CHECK(fault("A = 1e999").starts_with("k.tsc:4: '1e999'"));
    CHECK(fault("= 1").starts_with("k.tsc:4: a name is wanted"));
    CHECK(TextKernel::parse("KPL/LSK\nA = 1\n", "k").error().message ==
          "k:1: it has no line \\begindata: it is no text kernel");
    CHECK(TextKernel::parse(data("A = 1"), "k")->numbers("B", 1).error().message == "k: it says no B");
    CHECK(TextKernel::parse(data("A = 1"), "k")->numbers("A", 2).error().message ==
          "k:4: A has 1 values where 2 are wanted");
}

TEST_CASE("any cut and any spoilt octet of a kernel gives a kernel or a fault with its file", "[telemetry][kernel]") {
    const std::string whole =
        data("DELTET/DELTA_AT = ( 10, @1972-JAN-1\n 11, @1972-JUL-1 )\nNAME += 'x'\nM = ( 6.2D0 1.9D-7 )");
    std::mt19937 random{7};
    const auto readable = [](const std::string& text) {
        const auto kernel = TextKernel::parse(text, "k");
        return kernel || kernel.error().message.starts_with("k:");
    };
    for (std::size_t i = 0; i <= whole.size(); ++i) REQUIRE(readable(whole.substr(0, i)));
    for (int round = 0; round < 3000; ++round) {
        std::string spoilt = whole;
        for (int n = 0; n < 3; ++n) spoilt[random() % spoilt.size()] = static_cast<char>(random() % 256);
        REQUIRE(readable(spoilt));
    }
}

}  // namespace telemetry_text_kernel_test
