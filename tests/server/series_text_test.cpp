// SPDX-License-Identifier: Apache-2.0
#include "server/api/series_text.hpp"

#include "server/base/json.hpp"
#include "tests/support/catch.hpp"

#include <google/protobuf/util/message_differencer.h>
#include <limits>

namespace server_series_text_test {

using namespace aeolis;
using namespace aeolis::server;
using google::protobuf::util::MessageDifferencer;

namespace {

v1::ChannelSeries& add_series(v1::ChannelSeriesList& list, const char* name) {
    auto& series = *list.add_channels();
    series.set_id(7);
    series.set_name(name);
    series.set_unit("m/s");
    series.set_samples(UINT64_C(9007199254740993));  // one that no double holds
    for (const double value : {0.0, -1.5, 397000845.015625, 0.1, 1e-300, 1e21, 5869.125}) {
        series.add_sclk(397000845.0 + value);
        series.add_value(value);
        series.add_source(series.source_size() % 2 == 0 ? v1::SOURCE_REALTIME : v1::SOURCE_RECORDED);
    }
    return series;
}

std::string json_of(const v1::ChannelSeriesList& list) {
    return series_text(SeriesFormat::json, list);
}

}  // namespace

TEST_CASE("a series as JSON is what the schema's own printer makes of it", "[http][export]") {
    v1::ChannelSeriesList list;
    CHECK(json_of(list) == to_json(list));
    add_series(list, "speed_mps");
    auto& second = add_series(list, "altitude_m");
    second.set_thinned(true);
    second.add_origins()->set_link("uhf_live");
    second.add_gaps()->set_reason("uhf_live: plasma blackout");
    v1::ChannelSeriesList back;
    REQUIRE(from_json(json_of(list), back));
    CHECK(MessageDifferencer::Equals(list, back));
    list.mutable_channels(0)->mutable_sclk()->Clear();
    list.mutable_channels(0)->mutable_value()->Clear();
    list.mutable_channels()->RemoveLast();
    // Texts stand in the place of values.
    auto by_protobuf = to_json(list);
    const std::string no_texts = "\"text\":[],";
    by_protobuf.erase(by_protobuf.find(no_texts), no_texts.size());
    CHECK(json_of(list) == by_protobuf);
}

TEST_CASE("an undefined value is null and an empty cell; texts and whole numbers of more than 53 bits are exact",
          "[http][export][R54]") {
    v1::ChannelSeriesList list;
    auto& series = *list.add_channels();
    series.set_name("BIG");
    for (const char* text : {"9007199254740993", "", "a,b"}) {
        series.add_sclk(1.0);
        series.add_value(std::numeric_limits<double>::quiet_NaN());
        series.add_source(v1::SOURCE_REALTIME);
        series.add_text()->set_text(text);
    }
    series.mutable_text(1)->clear_text();
    CHECK_THAT(json_of(list), Catch::Contains(R"("value":["9007199254740993",null,"a,b"])"));
    CHECK(series_text(SeriesFormat::csv, list) == "channel,unit,sclk_s,value,source\nBIG,,1,9007199254740993,realtime\n"
                                                  "BIG,,1,,realtime\nBIG,,1,\"a,b\",realtime\n");
}

TEST_CASE("names of any kind and numbers that are none come back from JSON as they were", "[http][export]") {
    v1::ChannelSeriesList list, back;
    auto& series = add_series(list, "speed_mps*2 > \"x\\y\"\n<b>\xc2\xb5");
    for (const double value : {std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()})
        series.add_value(value);
    REQUIRE(from_json(json_of(list), back));
    CHECK(MessageDifferencer::Equals(list, back));
    series.add_value(std::numeric_limits<double>::quiet_NaN());
    CHECK_THAT(json_of(list), Catch::Contains(R"("Infinity","-Infinity",null])"));
}

}  // namespace server_series_text_test
