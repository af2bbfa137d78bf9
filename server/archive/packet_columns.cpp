// SPDX-License-Identifier: Apache-2.0
#include "server/archive/packet_columns.hpp"

#include <algorithm>
#include <limits>

namespace aeolis::archive {

namespace {
constexpr double undefined = std::numeric_limits<double>::quiet_NaN();
}

PacketColumns::PacketColumns(const dictionary::Dictionary& dictionary)
    : packets_(dictionary.packets.size()), places_(dictionary.channels.size()) {
    for (std::size_t p = 0; p < dictionary.packets.size(); ++p) {
        const auto& fields = dictionary.packets[p].fields;
        for (std::size_t f = 0; f < fields.size(); ++f) {
            if (!fields[f].channel) continue;
            places_[fields[f].channel->value].push_back({static_cast<std::uint16_t>(p), packets_[p].channels.size()});
            packets_[p].channels.push_back(*fields[f].channel);
            packets_[p].fields.push_back(f);
        }
    }
}

void PacketColumns::append_values(const telemetry::Decoded& decoded, std::vector<double>& values) const {
    for (const std::size_t field : packets_[decoded.packet].fields)
        values.push_back(decoded.value[field].value_or(undefined));
}

std::vector<SampleText> PacketColumns::texts(const telemetry::Decoded& decoded) const {
    std::vector<SampleText> texts;
    const auto& fields = packets_[decoded.packet].fields;
    for (const auto& [field, text] : decoded.texts)
        if (const auto column = std::ranges::find(fields, field); column != fields.end())
            texts.push_back({static_cast<std::size_t>(column - fields.begin()), text});
    return texts;
}

bool PacketColumns::defined(const telemetry::Decoded& decoded, std::size_t column) const {
    const std::size_t field = packets_[decoded.packet].fields[column];
    return decoded.value[field] ||
           std::ranges::find(decoded.texts, field, &std::pair<std::size_t, std::string>::first) != decoded.texts.end();
}

double PacketColumns::value(const telemetry::Decoded& decoded, std::size_t column) const {
    return decoded.value[packets_[decoded.packet].fields[column]].value_or(undefined);
}

}  // namespace aeolis::archive
