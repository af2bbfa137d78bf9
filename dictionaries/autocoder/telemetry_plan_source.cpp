// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/telemetry_plan_source.hpp"

#include "dictionaries/autocoder/cpp_text.hpp"

#include <algorithm>
#include <sstream>

namespace aeolis::dictionary::autocoder {
namespace {

/// Name of the encoder of the row's packet; for event reports, which share an APID, the name of any of them.
std::string encoder_of(const Dictionary& dictionary, const TelemetryPlanRow& row) {
    const auto packet = std::ranges::find(dictionary.packets, row.apid, &Packet::apid);
    if (packet == dictionary.packets.end()) return row.packet;  // the loader ensures that there is one
    return (packet->event ? "evr::" : "packet::") + packet->name;
}

}  // namespace

std::string telemetry_plan_source(const Dictionary& dictionary) {
    std::ostringstream out;
    out << made_by_autocoder(dictionary, "the spreadsheets")
        << "#include \"flight/edl_comm/telemetry_plan.hpp\"\n\n"
           "#include <array>\n\n"
           "namespace aeolis::flight {\nnamespace {\n\n"
        << "constexpr std::array<TelemetryPlanRow, " << dictionary.telemetry_plan.size() << "> rows{{\n";
    for (const TelemetryPlanRow& row : dictionary.telemetry_plan) {
        out << "#line " << row.line << " \"telemetry_plan.csv\"\n    {"
            << (row.plan == "all" ? "std::nullopt" : "Plan::" + row.plan) << ", " << encoder_of(dictionary, row)
            << "::apid, TelemetryPriority::" << telemetry_priority_words[static_cast<std::size_t>(row.priority)];
        for (std::size_t i = 0; i < row.every.size(); ++i)
            out << (i == 0 ? ", {." : ", .") << telemetry_state_columns[i] << " = " << row.every[i];
        out << "}},\n";
    }
    out << "}};\n\n}  // namespace\n\nconstinit const std::span<const TelemetryPlanRow> telemetry_plan_rows{rows};\n\n"
           "}  // namespace aeolis::flight\n";
    return out.str();
}

}  // namespace aeolis::dictionary::autocoder
