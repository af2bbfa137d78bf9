// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/autocoder/timeline_source.hpp"

#include "dictionaries/autocoder/constraint_table.hpp"
#include "dictionaries/autocoder/cpp_text.hpp"

#include <algorithm>
#include <sstream>

namespace aeolis::dictionary::autocoder {
namespace {

template <typename Id>
std::string id_literal(const char* type, const std::optional<Id>& id) {
    return id ? std::string{type} + "{" + std::to_string(unsigned{id->value}) + "}" : "std::nullopt";
}

/// Id of the row with that name; the loader ensures that there is one.
template <typename Rows>
auto id_of(const Rows& rows, const std::string& name) {
    using Id = decltype(rows.front().id);
    const auto found = std::ranges::find_if(rows, [&](const auto& row) { return row.name == name; });
    return name.empty() || found == rows.end() ? std::optional<Id>{} : std::optional<Id>{found->id};
}

/// A misspelt action does not compile, at its row of timeline.csv: flight/timeline/actions.hpp.
std::string action_named(const TimelineRow& row) {
    return "action_named<" + string_literal(row.action) + ">()";
}

void write_timeline(const Dictionary& dictionary, std::ostringstream& out) {
    out << "constinit const std::array<TimepointSpec, timepoint_count> timeline_specs{{\n";
    for (const TimelineRow& row : dictionary.timeline)
        out << "#line " << row.line << " \"timeline.csv\"\n    {" << string_literal(row.name) << ", "
            << id_literal("AnchorId", row.anchor) << ", " << optional_literal(row.desired_offset_s) << ", "
            << optional_literal(row.minimum_offset_s) << ", "
            << (row.action.empty() ? "nullptr" : action_named(row) + ".run") << ", "
            << optional_literal(row.reply_timeout_s) << ", IfUnverified::" << name_of(row.if_unverified) << ", "
            << optional_literal(row.hold_repeat_s) << ", "
            << id_literal("TimepointId", id_of(dictionary.timeline, row.backtrack)) << ", "
            << (row.essential ? "true" : "false") << ", " << (row.may_be_late ? "true" : "false") << ", "
            << id_literal("ToneId", row.tone) << ", "
            << (row.event.empty() ? "nullptr" : "&announce<evr::" + row.event + ">") << ", "
            << (row.action.empty() ? "std::nullopt" : action_named(row) + ".owner") << "},\n";
    out << "}};\n\n";
}

void write_anchors(const Dictionary& dictionary, std::ostringstream& out) {
    out << "#line 1 \"anchors.csv\"\nconstinit const std::array<AnchorSpec, anchor_count> anchor_specs{{\n";
    for (const AnchorRow& row : dictionary.anchors)
        out << "    {" << string_literal(row.name) << ", " << id_literal("AnchorId", row.parent) << ", "
            << optional_literal(row.offset_s) << "},\n";
    out << "}};\n\n";
}

/// A misspelt phase does not compile, at its row of tones.csv.
std::string heartbeat_of(const ToneRow& row) {
    const bool is_one = row.set == ToneSet::prime && row.name.starts_with(heartbeat_prefix);
    return is_one ? "EdlPhase::" + row.name.substr(heartbeat_prefix.size()) : "std::nullopt";
}

void write_tones(const Dictionary& dictionary, std::ostringstream& out) {
    out << "#line 1 \"tones.csv\"\nconstinit const std::array<ToneSpec, 256> tone_specs{{\n";
    for (const ToneRow& row : dictionary.tones)
        out << "    {" << static_cast<unsigned>(row.set) << ", " << row.priority << ", "
            << double_literal(row.expires_s) << ", " << id_literal("ToneId", id_of(dictionary.tones, row.supersedes))
            << ", "
            << id_literal("ToneId", row.set == ToneSet::prime
                                        ? id_of(dictionary.tones, std::string{second_chance_prefix} + row.name)
                                        : std::optional<ToneId>{})
            << ", " << heartbeat_of(row) << "},\n";
    out << "}};\n\n";
}

}  // namespace

std::string timeline_source(const Dictionary& dictionary) {
    std::ostringstream out;
    out << made_by_autocoder(dictionary, "the spreadsheets")
        << "#include \"flight/timeline/actions.hpp\"\n#include \"flight/timeline/constraint_monitor.hpp\"\n"
           "#include \"flight/timeline/timepoint.hpp\"\n\n"
           "namespace aeolis::flight {\n\n";
    write_timeline(dictionary, out);
    write_anchors(dictionary, out);
    write_tones(dictionary, out);
    out << constraint_table(dictionary);
    out << "}  // namespace aeolis::flight\n";
    return out.str();
}

}  // namespace aeolis::dictionary::autocoder
