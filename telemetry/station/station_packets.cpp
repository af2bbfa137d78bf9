// SPDX-License-Identifier: Apache-2.0
#include "telemetry/station/station_packets.hpp"

#include "common/bytes.hpp"
#include "common/space_packet.hpp"

namespace aeolis::telemetry {
namespace {

constexpr std::size_t carrier_data_octets = 26, seen_data_octets = 27, spectrum_data_octets = 8 + thinned_bins;

}  // namespace

std::vector<std::uint8_t> station_carrier_packet(const ReceivedCarrier& carrier, Sclk sent, std::uint16_t count,
                                                 std::uint16_t dictionary_id) {
    std::vector<std::uint8_t> packet(tm_overhead_octets + carrier_data_octets);
    BitWriter out{std::span{packet}.subspan(tm_data_offset_octets, carrier_data_octets)};
    out.put(carrier.estimate ? 0xF0 : 0x00, 8);  // the four values are defined, or none is
    out.put(static_cast<std::uint64_t>(carrier.lock), 8);
    out.put_double(carrier.predict_hz);
    const auto estimate = carrier.estimate.value_or(ReceivedCarrier::Estimate{});
    out.put_float(static_cast<float>(estimate.residual_hz));
    out.put_float(static_cast<float>(estimate.sigma_hz));
    out.put_float(static_cast<float>(estimate.rate_hzps));
    out.put_float(static_cast<float>(estimate.c_n0_dbhz));
    seal_tm_packet(packet, station_carrier_apid, count, sent, dictionary_id);
    return packet;
}

std::vector<std::uint8_t> station_spectrum_packet(const ReceivedSpectrum& spectrum, Sclk sent, std::uint16_t count,
                                                  std::uint16_t dictionary_id) {
    std::vector<std::uint8_t> packet(tm_overhead_octets + spectrum_data_octets);
    BitWriter out{std::span{packet}.subspan(tm_data_offset_octets, spectrum_data_octets)};
    out.put_float(static_cast<float>(spectrum.row.first_hz));
    out.put_float(static_cast<float>(spectrum.row.bin_hz));
    for (const std::uint8_t level : spectrum.row.levels) out.put(level, 8);
    seal_tm_packet(packet, station_spectrum_apid, count, sent, dictionary_id);
    return packet;
}

std::vector<std::uint8_t> seen_by_doppler_packet(const SeenByDoppler& seen, EvrId id, Sclk sent, Sclk entry,
                                                 std::uint16_t count, std::uint16_t dictionary_id) {
    std::vector<std::uint8_t> packet(tm_overhead_octets + seen_data_octets);
    BitWriter out{std::span{packet}.subspan(tm_data_offset_octets, seen_data_octets)};
    out.put(id.value, 16);
    out.put(static_cast<std::uint64_t>(seen.feature), 8);
    out.put_double(sent - entry);
    out.put_float(static_cast<float>(seen.evidence_hz));
    out.put_float(static_cast<float>(seen.sigma_hz));
    out.put_double(static_cast<double>(seen.ert.microseconds - seen.at.microseconds) * 1.0e-6);
    seal_tm_packet(packet, station_event_apid, count, sent, dictionary_id);
    return packet;
}

}  // namespace aeolis::telemetry
