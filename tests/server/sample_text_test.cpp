// SPDX-License-Identifier: Apache-2.0
#include "server/api/sample_text.hpp"

#include "tests/server/small_mission.hpp"
#include "tests/support/catch.hpp"

#include <limits>

namespace server_sample_text_test {

using namespace aeolis;
using namespace aeolis::test;
using archive::ChannelValue;
using archive::Source;
using server::SampleText;

namespace {

const dictionary::Dictionary& words() {
    static const auto dictionary = small_dictionary();
    return dictionary;
}
ChannelId id(const char* name) {
    return words().channel(name)->id;
}
/// The whole text; samples in pieces as they may come.
std::string text_of(const std::vector<std::string>& channels, const SampleText::Options& options,
                    const std::vector<std::vector<ChannelValue>>& pieces) {
    auto lines = std::move(SampleText::make(words(), channels, options)).value();
    lines.set_entry(Sclk{100.0});
    auto text = lines.head();
    for (const auto& piece : pieces) lines.append(text, piece);
    lines.finish(text);
    return text;
}
std::vector<ChannelValue> some() {
    const auto altitude = id("altitude_m"), speed = id("speed_mps");
    return {{speed, 3.0, Sclk{100.0}, Source::realtime},
            {altitude, 9.5, Sclk{100.25}, Source::realtime},
            {speed, 2.0, Sclk{100.25}, Source::recorded},
            {speed, 1.0, Sclk{100.5}, Source::realtime},
            {altitude, 8.0, Sclk{107.0}, Source::realtime}};
}

}  // namespace

TEST_CASE("a line a sample says when, what, how much and by which link", "[export]") {
    CHECK(text_of({}, {"csv", ""}, {some()}) == "sclk,e_s,channel,value,unit,source\n"
                                                "100,0,speed_mps,3,m/s,realtime\n"
                                                "100.25,0.25,altitude_m,9.5,m,realtime\n"
                                                "100.25,0.25,speed_mps,2,m/s,recorded\n"
                                                "100.5,0.5,speed_mps,1,m/s,realtime\n"
                                                "107,7,altitude_m,8,m,realtime\n");
    const std::vector<ChannelValue> endless{
        {id("speed_mps"), std::numeric_limits<double>::infinity(), Sclk{100.0}, Source::realtime}};
    CHECK(text_of({}, {"jsonl", ""}, {endless}) ==
          R"({"sclk":100,"e_s":0,"channel":"speed_mps","value":"Infinity","unit":"m/s","source":"realtime"})"
          "\n");
}

TEST_CASE("names and units that are hostile to the format are quoted as it wants them", "[export]") {
    auto dictionary = small_dictionary();
    auto& channel = dictionary.channels[id("speed_mps").value];
    channel.name = "a \"quoted\", name";
    channel.type.unit = "m\n/s";
    const auto line_of = [&](const char* format) {
        auto lines = std::move(SampleText::make(dictionary, {}, {format, ""})).value();
        lines.set_entry(Sclk{100.0});
        std::string text;
        lines.append(text, std::vector<ChannelValue>{{channel.id, 3.0, Sclk{100.0}, Source::realtime}});
        return text;
    };
    CHECK(line_of("csv") == "100,0,\"a \"\"quoted\"\", name\",3,\"m\n/s\",realtime\n");
    CHECK(line_of("jsonl") ==
          R"({"sclk":100,"e_s":0,"channel":"a \"quoted\", name","value":3,"unit":"m\u000a/s","source":"realtime"})"
          "\n");
}

TEST_CASE("aligned to a channel there is a line at each of its times, with the newest value of the others",
          "[export]") {
    CHECK(text_of({"altitude_m", "speed_mps"}, {"csv", "speed_mps"}, {some()}) == "sclk,e_s,altitude_m,speed_mps\n"
                                                                                  "100,0,,3\n"
                                                                                  "100.25,0.25,9.5,2\n"
                                                                                  "100.5,0.5,9.5,1\n");
    CHECK(text_of({"altitude_m", "speed_mps"}, {"jsonl", "altitude_m"}, {some()}) ==
          R"({"sclk":100.25,"e_s":0.25,"altitude_m":9.5,"speed_mps":2})"
          "\n"
          R"({"sclk":107,"e_s":7,"altitude_m":8,"speed_mps":1})"
          "\n");
}

TEST_CASE("aligned to a step a silence makes no lines", "[export]") {
    CHECK(text_of({"altitude_m", "speed_mps"}, {"csv", "0.5"}, {some()}) == "sclk,e_s,altitude_m,speed_mps\n"
                                                                            "100,0,,3\n"
                                                                            "100.5,0.5,9.5,1\n"
                                                                            "107,7,8,1\n");
}

TEST_CASE("aligned to tenths the times are those of the decimal text, not sums of what a tenth is as a double",
          "[export]") {
    const auto speed = id("speed_mps");
    std::vector<ChannelValue> samples;
    for (int i = 0; i < 4; ++i) samples.push_back({speed, double(i), Sclk{100.0 + 0.25 * i}, Source::realtime});
    auto lines = std::move(SampleText::make(words(), {"speed_mps"}, {"csv", "0.1"})).value();
    lines.set_entry(Sclk{0.0});
    std::string text;
    lines.append(text, samples);
    lines.finish(text);
    CHECK(text == "100,,0\n"  // the time of entry is not known
                  "100.3,,1\n"
                  "100.5,,2\n"
                  "100.8,,3\n");
}

TEST_CASE("the text is the same in whatever pieces the samples come", "[export]") {
    const auto all = some();
    for (const char* align : {"", "speed_mps", "0.5", "3"})
        for (std::size_t cut : {1U, 3U, 4U}) {  // not within an instant
            const std::vector<ChannelValue> first(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(cut)),
                rest(all.begin() + static_cast<std::ptrdiff_t>(cut), all.end());
            INFO(align << " cut at " << cut);
            CHECK(text_of({"speed_mps", "altitude_m"}, {"csv", align}, {first, rest}) ==
                  text_of({"speed_mps", "altitude_m"}, {"csv", align}, {all}));
        }
}

TEST_CASE("what cannot be aligned is named", "[export]") {
    const auto refused = [](const std::vector<std::string>& channels, const SampleText::Options& options) {
        return SampleText::make(words(), channels, options).error().message;
    };
    CHECK(refused({}, {"xlsx", ""}) == "format: 'xlsx' is neither csv nor jsonl");
    CHECK(refused({}, {"csv", "1"}) == "align: the columns are the channels that are named, and none is");
    CHECK(refused({"speed_mps"}, {"csv", "altitude_m"}) ==
          "align: 'altitude_m' is neither one of the channels nor seconds");
    CHECK(refused({"speed_mps", "speed_mps"}, {"csv", "1"}) == "channel 'speed_mps' is named twice");
    const auto alias = words().channel("speed_mps")->alias;
    REQUIRE_FALSE(alias.empty());
    CHECK(refused({"speed_mps", alias}, {"csv", "1"}) == "channel '" + alias + "' is named twice");
    CHECK(refused({"altitud"}, {"csv", "1"}) == "no channel 'altitud'");
    for (const char* step : {"0", "-1", "nan", "inf", "1e-9", "1e9"})
        CHECK_THAT(refused({"speed_mps"}, {"csv", step}), Catch::StartsWith("align: "));
}

}  // namespace server_sample_text_test
