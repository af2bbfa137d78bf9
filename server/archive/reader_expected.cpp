// SPDX-License-Identifier: Apache-2.0
#include "server/archive/reader_state.hpp"
#include "telemetry/station/expected_values.hpp"

#include <algorithm>
#include <limits>
#include <map>

namespace aeolis::archive {
namespace {

constexpr std::string_view values_packet = "ShadowValues";
constexpr char values_sql[] =
    "SELECT octets, sclk FROM packets WHERE run = ?1 AND apid = ?2 AND source = ?3 ORDER BY sclk, key";
constexpr double second_s = 1.0;

/// A series under way. A value holds until the next one; of each, the part within the range has its first and its last
/// second, so that a value that does not change has both.
class Growing {
  public:
    Growing(Reader::ExpectedSeries& series, const SclkRange& range) : series_(series), range_(range) {}

    void add(Sclk at, const std::optional<double>& value) {
        end(std::max(last_at_s_, at.seconds - second_s));
        last_ = value;
        last_at_s_ = at.seconds;
    }
    /// The last value holds to here.
    void end(double at_s) {
        if (!last_) return;
        const double from_s = std::max(last_at_s_, range_.from_s.value_or(last_at_s_));
        const double to_s = std::min(at_s, range_.to_s.value_or(at_s));
        if (from_s > to_s) return;
        put(from_s, *last_);
        if (to_s > from_s) put(to_s, *last_);
    }

  private:
    void put(double sclk_s, double value) {
        series_.sclk_s.push_back(sclk_s);
        series_.value.push_back(value);
    }

    Reader::ExpectedSeries& series_;
    SclkRange range_;
    std::optional<double> last_;
    double last_at_s_ = 0.0;
};

}  // namespace

Result<std::vector<Reader::ExpectedSeries>> Reader::expected_values(RunId run, const std::vector<ChannelId>& channels,
                                                                    const SclkRange& range) {
    std::vector<ExpectedSeries> series(channels.size());
    const auto* packet = state_->dictionary.packet(values_packet);
    if (packet == nullptr || !packet->content) return series;
    std::map<std::uint16_t, Growing> growing;
    for (std::size_t i = 0; i < channels.size(); ++i) growing.emplace(channels[i].value, Growing{series[i], range});
    auto rows = state_->query(values_sql);
    if (!rows) return rows.error();
    (*rows)
        ->bind(1, std::int64_t{run.value})
        .bind(2, std::int64_t{packet->apid.value})
        .bind(3, static_cast<std::int64_t>(Source::realtime));
    double last_s = -std::numeric_limits<double>::infinity();
    for (;;) {
        const auto found = (*rows)->step();
        if (!found) return found.error();
        if (!*found) break;
        const auto octets = (*rows)->octets(0);
        const auto& content = *packet->content;
        if (octets.size() < content.offset_octets + content.octets) continue;
        last_s = (*rows)->real(1);
        telemetry::unpack_expected_values(std::span{octets}.subspan(content.offset_octets, content.octets),
                                          Sclk{last_s}, [&](const telemetry::ExpectedValue& each) {
                                              const auto wanted = growing.find(each.channel.value);
                                              if (wanted != growing.end()) wanted->second.add(each.at, each.value);
                                          });
    }
    for (auto& [channel, each] : growing) each.end(last_s);
    return series;
}

}  // namespace aeolis::archive
