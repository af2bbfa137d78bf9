// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time_table.hpp"
#include "simulation/links/carrier_model.hpp"
#include "simulation/links/x_band_front_end.hpp"
#include "simulation/random.hpp"
#include "telemetry/port.hpp"

#include <cstdint>
#include <optional>

namespace aeolis::simulation {

/// Ground's receiver of X-band in statistical form: carrier, state of the link, and tones, from what arrives alone.
///
/// In       X-band fields, one a cycle without a gap        Out   what a receiver of samples would report
/// Link     up while the carrier is followed; before the first one it is down after a search of 10 s, as with samples
/// Tones    one decision for each symbol during which the carrier was heard, none for others. It is drawn from the
///          exact symbol error of a symbol as long as the carrier was heard with the tone (detect_tone), at its mean
///          level. Erased: likelihood below 0.9, or heard for less than a quarter of the 10 s
/// Assumed  the receiver knows when symbols begin
/// A value; copies continue alike.
class XBandReceiverModel {
  public:
    /// `predict_hz`: by seconds from the scenario's entry.
    XBandReceiverModel(double total_c_n0_dbhz, TimeTable predict_hz, std::uint64_t seed, std::uint64_t case_number);

    /// `out.station_out`: nothing arrives, and the station knows it.
    void hear(const XBandField& field, telemetry::Downlink& out);

  private:
    struct Symbol {
        ToneId tone;
        Ert start;
        double age_s = 0.0;
        int heard_ticks = 0;
        double gain_sum = 0.0;    ///< over those ticks
        double doppler_hz = 0.0;  ///< mean of the estimates, or the predict
        int estimates = 0;
        CarrierLock worst = CarrierLock::locked;
    };
    void note(const telemetry::ReceivedCarrier& carrier);
    std::optional<telemetry::ReceivedTone> decide(const Symbol& symbol);
    void tell_link(const XBandField& field, telemetry::Downlink& out);

    double total_c_n0_dbhz_;
    TimeTable predict_hz_;
    CarrierModel carrier_;
    Random random_;
    std::optional<Symbol> symbol_;
    bool found_ = false;  ///< the carrier, in the newest eighth
    CarrierLock lock_ = CarrierLock::searching;
    std::int64_t without_ticks_ = 0;
    std::optional<bool> up_;  ///< as last reported; none: not yet
};

}  // namespace aeolis::simulation
