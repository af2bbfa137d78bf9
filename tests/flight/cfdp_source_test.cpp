// SPDX-License-Identifier: Apache-2.0
#include "flight/file_delivery/cfdp_source.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/octets.hpp"

#include <optional>
#include <type_traits>

namespace flight_cfdp_source_test {

using namespace aeolis;
using namespace aeolis::flight;

namespace {

using Octets = std::vector<std::uint8_t>;
constexpr CfdpSource::File description{76, 1, 9, 2500, 1000};

/// The source with its file, and what it sends.
struct Sender {
    Octets file = [] {
        std::mt19937 random{1};
        return test::random_octets(random, description.octets);
    }();
    CfdpSource source{description, "recording"};
    Octets pdu = Octets(source.pdu_octets_max());

    /// What the next PDU says; none when there is nothing to send.
    std::optional<cfdp::Pdu> next() {
        const std::size_t size = source.next(file, pdu);
        if (size == 0) return std::nullopt;
        const auto read = cfdp::read(std::span{pdu}.first(size));
        REQUIRE(read);
        CHECK(read->header == cfdp::Header{.source = 76, .sequence = 9, .destination = 1});
        return *read;
    }
    /// Everything it has to say now.
    std::vector<cfdp::Range> ranges() {
        std::vector<cfdp::Range> sent;
        while (const auto now = next())
            if (const auto* data = std::get_if<cfdp::FileData>(&now->content))
                sent.push_back({data->offset, data->offset + static_cast<std::uint32_t>(data->octets.size())});
        return sent;
    }
    void hear(const cfdp::Content& content) {
        source.on({{.toward_sender = true, .source = 76, .sequence = 9, .destination = 1}, content});
    }
};

}  // namespace

static_assert(std::is_trivially_destructible_v<CfdpSource>);  // part of a computer, which is copied as a value

TEST_CASE("a file goes out as metadata, its octets once, and its end with size and checksum", "[flight]") {
    Sender sender;
    const auto metadata = sender.next();
    REQUIRE(metadata);
    CHECK(std::get<cfdp::Metadata>(metadata->content).file_octets == 2500);
    CHECK(std::get<cfdp::Metadata>(metadata->content).destination_name == "recording");
    for (const std::uint32_t size : {1000U, 1000U, 500U})
        CHECK(std::get<cfdp::FileData>(sender.next()->content).octets.size() == size);
    const auto eof = std::get<cfdp::Eof>(sender.next()->content);
    CHECK(eof.file_octets == 2500);
    CHECK(eof.checksum == cfdp::modular_checksum(0, sender.file));
    CHECK_FALSE(sender.next());
}

TEST_CASE("what is asked for goes out again, once for each time it is asked for, and never from outside", "[flight]") {
    Sender sender;
    (void)sender.ranges();
    cfdp::Nak nak{{0, 2500}, {}};
    nak.requests.push_back({100, 1200});
    nak.requests.push_back({2400, 4000000000});
    nak.requests.push_back({3000, 4000});
    nak.requests.push_back({0, 0});
    sender.hear(nak);
    sender.hear(nak);  // heard twice before it was answered
    CHECK(sender.source.to_repeat_octets() == 1200);
    CHECK(std::holds_alternative<cfdp::Metadata>(sender.next()->content));
    CHECK(sender.ranges() == std::vector<cfdp::Range>{{100, 1100}, {1100, 1200}, {2400, 2500}});
    sender.hear(nak);
    CHECK(sender.ranges().size() == 3);
}

TEST_CASE("the end is announced again until it is acknowledged, and the end of all is acknowledged each time",
          "[flight]") {
    Sender sender;
    (void)sender.ranges();
    sender.source.repeat();
    CHECK(std::holds_alternative<cfdp::Eof>(sender.next()->content));
    sender.hear(cfdp::Ack{cfdp::Directive::eof});
    sender.source.repeat();
    CHECK_FALSE(sender.next());
    for (int i = 0; i < 3; ++i) {
        sender.hear(cfdp::Finished{});
        CHECK_FALSE(sender.source.done());
        CHECK(std::get<cfdp::Ack>(sender.next()->content).of == cfdp::Directive::finished);
        CHECK(sender.source.done());
        CHECK(sender.source.delivered());
    }
}

TEST_CASE("a receiver that gave up is believed: the file was not delivered", "[flight]") {
    Sender sender;
    sender.hear(cfdp::Finished{cfdp::Condition::file_checksum_failure, false, 0});
    CHECK(sender.ranges().empty());
    CHECK(sender.source.done());
    CHECK_FALSE(sender.source.delivered());
}

TEST_CASE("PDUs of other transactions, or for a receiver, change nothing", "[flight]") {
    Sender sender;
    (void)sender.ranges();
    for (const cfdp::Header& header :
         {cfdp::Header{.toward_sender = false, .source = 76, .sequence = 9, .destination = 1},
          cfdp::Header{.toward_sender = true, .source = 77, .sequence = 9, .destination = 1},
          cfdp::Header{.toward_sender = true, .source = 76, .sequence = 8, .destination = 1},
          cfdp::Header{.toward_sender = true, .source = 76, .sequence = 9, .destination = 2}})
        sender.source.on({header, cfdp::Finished{}});
    sender.hear(cfdp::FileData{});
    sender.hear(cfdp::Prompt{});
    CHECK_FALSE(sender.next());
    CHECK_FALSE(sender.source.done());
}

TEST_CASE("more requests than there is room for are dropped, not kept elsewhere", "[flight]") {
    Sender sender;
    (void)sender.ranges();
    for (std::uint32_t i = 0; i < 1000; ++i) {
        cfdp::Nak nak;
        nak.requests.push_back({2 * i, 2 * i + 1});
        sender.hear(nak);
    }
    CHECK(sender.ranges().size() == CfdpSource::ranges_max);
}

TEST_CASE("an empty file is announced and ended", "[flight]") {
    CfdpSource source{{76, 1, 9, 0, 1000}, "empty"};
    Octets pdu(source.pdu_octets_max());
    std::size_t sent = 0;
    while (source.next({}, pdu) > 0) ++sent;
    CHECK(sent == 2);
}

}  // namespace flight_cfdp_source_test
