// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/station_packets.hpp"

#include "telemetry/decommutator.hpp"
#include "tests/support/catch.hpp"
#include "tests/support/shipped_dictionary.hpp"

#include <algorithm>
#include <array>
#include <utility>

namespace telemetry_station_packets_test {

using namespace aeolis;
using namespace aeolis::telemetry;

namespace {

/// The value of a channel in a packet as the dictionary decodes it; none: undefined.
std::optional<double> value(const std::vector<std::uint8_t>& packet, std::string_view name) {
    const auto& dictionary = tests::shipped_dictionary();
    const Decommutator decommutator{dictionary};
    Decoded decoded;
    REQUIRE_FALSE(decommutator.decode(packet, decoded));
    const auto& fields = dictionary.packets[decoded.packet].fields;
    const auto field = std::ranges::find(fields, name, &dictionary::Field::name);
    REQUIRE(field != fields.end());
    CHECK(field->channel);
    return decoded.value[static_cast<std::size_t>(field - fields.begin())];
}

}  // namespace

TEST_CASE("the carrier's estimates are channels of the dictionary, and undefined where it was not heard",
          "[station][R54]") {
    const auto id = tests::shipped_dictionary().id;
    ReceivedCarrier carrier;
    carrier.lock = CarrierLock::fluctuating;
    carrier.predict_hz = -412'345.678;
    carrier.estimate = {-1234.5, 0.078125, -60.25, 21.75};
    const auto heard = station_carrier_packet(carrier, Sclk{1000.5}, 7, id);
    CHECK(read_tm_packet(heard)->time == Sclk{1000.5});
    CHECK(value(heard, "carrier_lock") == 1.0);
    CHECK(value(heard, "carrier_predict_hz") == -412'345.678);
    CHECK(value(heard, "carrier_residual_hz") == -1234.5);
    CHECK(value(heard, "carrier_sigma_hz") == 0.078125);
    CHECK(value(heard, "carrier_rate_hz_s") == -60.25);
    CHECK(value(heard, "carrier_cn0_dbhz") == 21.75);

    carrier.lock = CarrierLock::searching;
    carrier.estimate.reset();
    const auto lost = station_carrier_packet(carrier, Sclk{1000.625}, 8, id);
    CHECK(value(lost, "carrier_lock") == 3.0);
    CHECK(value(lost, "carrier_predict_hz") == -412'345.678);
    for (const char* name : {"carrier_residual_hz", "carrier_sigma_hz", "carrier_rate_hz_s", "carrier_cn0_dbhz"})
        CHECK_FALSE(value(lost, name));
}

TEST_CASE("a spectrum is a packet of the dictionary, and 1000 s of them are no more than 1 MB", "[station][R54]") {
    const auto& dictionary = tests::shipped_dictionary();
    ReceivedSpectrum spectrum;
    spectrum.row.first_hz = -8192.0;
    spectrum.row.bin_hz = 32.0;
    spectrum.row.levels.assign(thinned_bins, 60);
    spectrum.row.levels[256] = 110;
    const auto packet = station_spectrum_packet(spectrum, Sclk{1000.5}, 7, dictionary.id);
    CHECK(packet.size() * 1000 < 600'000);
    const Decommutator decommutator{dictionary};
    Decoded decoded;
    REQUIRE_FALSE(decommutator.decode(packet, decoded));
    const auto& container = dictionary.packets[decoded.packet];
    CHECK(container.name == "StationSpectrum");
    CHECK(decoded.value[0] == -8192.0);
    CHECK(decoded.value[1] == 32.0);
    REQUIRE(container.content);
    CHECK(container.content->octets == thinned_bins);
    CHECK(packet[container.content->offset_octets + 255] == 60);
    CHECK(packet[container.content->offset_octets + 256] == 110);
}

TEST_CASE("the labels of the receiver's lock are those of the dictionary", "[station][R54]") {
    const auto* channel = tests::shipped_dictionary().channel("carrier_lock");
    REQUIRE(channel != nullptr);
    REQUIRE(channel->type.enumeration.size() == 4);
    for (const auto& [number, label, last] : channel->type.enumeration)
        CHECK(label == to_text(static_cast<CarrierLock>(number)));
}

TEST_CASE("the features seen by Doppler have in the dictionary the labels of their names", "[station][R54]") {
    using Feature = SeenByDoppler::Feature;
    constexpr std::array<std::pair<Feature, const char*>, 7> features{{{Feature::entry, "entry"},
                                                                       {Feature::parachute, "parachute"},
                                                                       {Feature::heatshield, "heatshield"},
                                                                       {Feature::first_reversal, "first_reversal"},
                                                                       {Feature::second_reversal, "second_reversal"},
                                                                       {Feature::third_reversal, "third_reversal"},
                                                                       {Feature::fourth_reversal, "fourth_reversal"}}};
    const auto& dictionary = tests::shipped_dictionary();
    const auto* event = dictionary.event("SEEN_BY_DOPPLER");
    REQUIRE(event != nullptr);
    const auto& fields = dictionary.packets[event->packet].fields;
    const auto labels = std::ranges::find(fields, "DopplerFeature", [](const auto& field) { return field.type.name; });
    REQUIRE(labels != fields.end());
    REQUIRE(labels->type.enumeration.size() == features.size());
    const Decommutator decommutator{dictionary};
    for (const auto& [feature, name] : features) {
        const auto packet = seen_by_doppler_packet({feature, Ert{1}, Ert{0}, 12.0, 1.0}, event->id, Sclk{1.0},
                                                   Sclk{0.0}, 1, dictionary.id);
        Decoded decoded;
        REQUIRE_FALSE(decommutator.decode(packet, decoded));
        const double sent = decoded.value[static_cast<std::size_t>(labels - fields.begin())].value_or(-1.0);
        const auto label =
            std::ranges::find_if(labels->type.enumeration, [&](const auto& each) { return each.holds(sent); });
        REQUIRE(label != labels->type.enumeration.end());
        CHECK(label->label == name);
    }
}

}  // namespace telemetry_station_packets_test
