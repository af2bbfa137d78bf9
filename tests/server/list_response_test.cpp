// SPDX-License-Identifier: Apache-2.0
#include "server/api/list_response.hpp"

#include "aeolis/v1/access.pb.h"
#include "aeolis/v1/layout.pb.h"
#include "aeolis/v1/run.pb.h"
#include "server/archive/reader.hpp"
#include "server/base/json.hpp"
#include "tests/support/catch.hpp"

#include <memory>
#include <utility>

namespace server_list_response_test {

using namespace aeolis;
using server::list_response;

namespace {

server::HttpResponse as(const char* format, const google::protobuf::Message& list, const server::Rows& rows) {
    const std::unique_ptr<google::protobuf::Message> given{list.New()};
    given->CopyFrom(list);
    return list_response(format, std::move(*given), rows);
}

v1::EventList two_events() {
    v1::EventList list;
    auto& first = *list.add_events();
    first.set_seq(7);
    first.mutable_event()->set_name("TOUCHDOWN");
    first.mutable_event()->set_level(v1::Event::ACTIVITY_HI);
    first.mutable_event()->set_text("a \"quoted\", text\nof two lines");
    first.mutable_event()->set_sclk(397000845.015625);
    first.mutable_event()->set_source(v1::SOURCE_RECORDED);
    list.add_events()->set_seq(UINT64_C(9007199254740993));  // one that no double holds
    list.set_next_after(9);
    return list;
}

}  // namespace

TEST_CASE("a list as CSV has a column a field by its path and a row a line, quoted by RFC 4180; what a row does not "
          "have is empty",
          "[http][export]") {
    const auto csv = as("csv", two_events(), {"events", {"event"}});
    CHECK(csv.content_type == "text/csv; charset=utf-8");
    CHECK(csv.field("Aeolis-Next-After") == "9");
    CHECK(csv.body ==
          "seq,event.id,event.name,event.level,event.text,event.sclk,event.ert,event.source,event.duplicate\n"
          "7,0,TOUCHDOWN,ACTIVITY_HI,\"a \"\"quoted\"\", text\nof two lines\",397000845.015625,,recorded,false\n"
          "9007199254740993,,,,,,,,\n");
    CHECK(as("csv", v1::EventList{}, {"events", {"event"}})
              .body.starts_with("seq,event.id,"));  // a header also of no rows
}

TEST_CASE("a list as JSON lines has its rows as they are in the list, one a line", "[http][export]") {
    const auto list = two_events();
    const auto lines = as("jsonl", list, {"events", {"event"}});
    CHECK(lines.content_type == "application/x-ndjson");
    CHECK(lines.field("Aeolis-Next-After") == "9");
    CHECK(lines.body == server::to_json(list.events(0)) + '\n' + server::to_json(list.events(1)) + '\n');
    CHECK(as("json", list, {"events", {"event"}}).body == server::to_json(list));
}

TEST_CASE(
    "as CSV a repeated field is one cell: numbers and texts with blanks between, messages as JSON, octets hexadecimal",
    "[http][export]") {
    v1::ToneList tones;
    auto& tone = *tones.add_tones()->mutable_tone();
    tone.set_spectrum(std::string{"\x00\xff", 2});
    tone.add_best()->set_tone(29);
    const auto csv = as("csv", tones, {"tones", {"tone"}}).body;
    CHECK_THAT(csv, Catch::Contains("tone.tone,") && Catch::Contains(",00ff\n"));
    CHECK_THAT(csv, Catch::Contains(R"("[{""tone"":29,""likelihood"":0}]")"));

    v1::ChannelSeriesList series;
    series.add_channels()->add_sclk(1.5);
    series.mutable_channels(0)->add_sclk(2.0);
    series.mutable_channels(0)->add_source(v1::SOURCE_REALTIME);
    const auto columns = as("csv", series, {"channels"});
    CHECK_THAT(columns.body, Catch::Contains(",1.5 2,,realtime,"));
    CHECK(columns.field("Aeolis-Next-After").empty());  // no pages
}

TEST_CASE("as CSV an SCLK has SCET beside it where the clock of the run is known", "[http][export]") {
    auto list = two_events();
    list.mutable_events(1)->mutable_event()->set_sclk(1e15);  // no date has so many digits
    const ClockCorrelation clock{Sclk{397000845.0}, *scet_from_text("2012-219T05:17:57.000")};
    const auto csv = list_response("csv", std::move(list), {"events", {"event"}}, clock).body;
    CHECK_THAT(csv, Catch::Contains(",event.sclk,event.scet,event.ert,") &&
                        Catch::Contains(",397000845.015625,2012-219T05:17:57.015,,recorded"));
    CHECK_THAT(csv, Catch::Contains(",1e+15,,,"));
    v1::TimepointList timepoints;
    timepoints.add_timepoints();
    CHECK_THAT(list_response("csv", std::move(timepoints), {"timepoints"}, clock).body, Catch::Contains("_scet,"));
}

TEST_CASE("what a spreadsheet would compute stands in CSV as the words that it is; numbers stay numbers",
          "[http][export]") {
    v1::NoteList notes;
    auto& note = *notes.add_notes()->mutable_note();
    const auto cell = [&](const char* text) {
        note.set_text(text);
        const auto csv = as("csv", notes, {"notes", {"note"}}).body;
        const auto row = csv.substr(csv.find('\n') + 1);
        return row.substr(2, row.find(",,,") - 2);  // behind seq
    };
    CHECK(cell("=A1&\"x\"") == R"q("'=A1&""x""")q");
    CHECK(cell("@SUM(1)") == "'@SUM(1)");
    CHECK(cell("+1 crew, -2") == "\"'+1 crew, -2\"");
    CHECK(cell("-altitude_m") == "'-altitude_m");
    CHECK(cell("-1.5e-3") == "-1.5e-3");
    CHECK(cell("-inf") == "-inf");
    CHECK(cell("'quoted' = words") == "'quoted' = words");
}

TEST_CASE("JSON that is made some rows at a time is the JSON of all of them", "[http][R62]") {
    v1::DictionaryReply reply;  // with fields before and behind the rows
    reply.set_mission(R"("channels":[ )");
    reply.add_commands()->set_name("DO_EDL");
    for (int rows = 0; rows < 12; ++rows) {
        CAPTURE(rows);
        CHECK(server::to_json_by_rows(v1::DictionaryReply{reply}, "channels") == server::to_json(reply));
        auto& channel = *reply.add_channels();
        channel.set_name("channel_" + std::to_string(rows));
        channel.set_text(std::string(rows % 2 == 0 ? 20'000 : 1, '"'));
        channel.add_labels()->set_label("on");
    }
}

TEST_CASE("a list made whole is given in pages by place, in either order, each row once", "[http][R62]") {
    for (const auto order : {archive::Order::oldest_first, archive::Order::newest_first})
        for (const std::size_t limit : {1U, 2U, 5U, 7U, 100U}) {
            CAPTURE(limit);
            std::string seen;
            std::uint64_t after = 0;
            for (int pages = 0; pages < 20; ++pages) {
                v1::UserList list;
                for (const char name : std::string{"abcdefg"}) list.add_users()->set_user(std::string(1, name));
                server::keep_page(list, "users", {after, limit, order});
                for (const auto& user : list.users()) seen += user.user();
                after = list.next_after();
                if (after == 0) break;
            }
            CHECK(seen == (order == archive::Order::oldest_first ? "abcdefg" : "gfedcba"));
        }
    v1::UserList list;
    list.add_users();
    server::keep_page(list, "users", {5, 10, archive::Order::oldest_first});
    CHECK((list.users().empty() && list.next_after() == 0));  // behind the end
    server::keep_page(list, "users", {0, 10, archive::Order::newest_first});
    CHECK((list.users().empty() && list.next_after() == 0));  // of no rows
}

TEST_CASE("a page of a list made whole ends once it is long", "[http][R62]") {
    v1::LayoutList list;
    for (int i = 0; i < 100; ++i) list.add_layouts()->set_view(std::string(20'000, 'x'));
    list.set_layouts_max(32);
    server::keep_page(list, "layouts", {0, 1'000, archive::Order::oldest_first});
    CHECK(list.ByteSizeLong() < archive::page_octets_max + 30'000);
    CHECK(list.next_after() == static_cast<std::uint64_t>(list.layouts_size()));
    CHECK(list.layouts_max() == 32);
}

}  // namespace server_list_response_test
