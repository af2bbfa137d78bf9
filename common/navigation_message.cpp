// SPDX-License-Identifier: Apache-2.0
#include "common/navigation_message.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdio>
#include <map>
#include <numbers>
#include <set>
#include <span>

namespace aeolis {
namespace {

constexpr double degree_as_rad = std::numbers::pi / 180.0;

std::string_view trimmed(std::string_view text) {
    const auto first = text.find_first_not_of(" \t\r");
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
}

std::vector<std::string_view> words_of(std::string_view line) {
    std::vector<std::string_view> words;
    while (!(line = trimmed(line)).empty()) {
        const auto end = std::min(line.find_first_of(" \t"), line.size());
        words.push_back(line.substr(0, end));
        line.remove_prefix(end);
    }
    return words;
}

/// What a kind of message consists of.
struct Grammar {
    std::string_view version_key;                 ///< CCSDS_OEM_VERS
    std::set<std::string_view> versions;          ///< that are read
    std::set<std::string_view> metadata, needed;  ///< keywords, and those that each segment has
    std::string_view data_start, data_stop;       ///< lines about the data; empty: data follow the metadata
    std::string_view passed_over;                 ///< a block begins with …_START and ends with …_STOP; empty: none
};

using Metadata = std::map<std::string, std::string, std::less<>>;

struct DataLine {
    std::size_t line = 0;
    EphemerisTime time;
    std::vector<double> numbers;
};
struct Segment {
    std::size_t line = 0;  ///< of its META_START
    Metadata metadata;
    TimeSystem system = TimeSystem::utc;
    std::vector<DataLine> data;
};

Error at_line(std::size_t line, const std::string& what) {
    return {"line " + std::to_string(line) + ": " + what};
}

/// Reads a message line by line.
class MessageReader {
  public:
    explicit MessageReader(const Grammar& grammar) : grammar_(grammar) {}

    Result<void> take(std::string_view raw) {
        ++line_;
        const std::string_view line = trimmed(raw);
        if (line.empty() || line == "COMMENT" || line.starts_with("COMMENT ")) return {};
        if (place_ == Place::passed_over) {
            if (line == std::string(grammar_.passed_over) + "_STOP") place_ = Place::data;
            return {};
        }
        if (line == "META_START") return begin_segment();
        if (line == "META_STOP") return end_metadata();
        if (!grammar_.passed_over.empty() && line == std::string(grammar_.passed_over) + "_START") {
            if (place_ != Place::data) return wrong("a block of covariances outside of a segment");
            place_ = Place::passed_over;
            return {};
        }
        if (!grammar_.data_start.empty() && line == grammar_.data_start) {
            if (place_ != Place::between) return wrong(std::string(line) + " without metadata before it");
            place_ = Place::data;
            return {};
        }
        if (!grammar_.data_stop.empty() && line == grammar_.data_stop) {
            if (place_ != Place::data) return wrong(std::string(line) + " without " + std::string(grammar_.data_start));
            place_ = Place::header;
            return {};
        }
        if (const auto equals = line.find('='); equals != std::string_view::npos)
            return keyword(trimmed(line.substr(0, equals)), trimmed(line.substr(equals + 1)));
        if (place_ == Place::data) return data(line);
        return wrong("'" + std::string(line.substr(0, line_shown_max)) +
                     "' is neither a keyword nor data of a segment");
    }

    Result<std::vector<Segment>> finish() {
        if (!version_) return Error{"has no " + std::string(grammar_.version_key) + " in its first line"};
        if (place_ == Place::metadata || place_ == Place::between || place_ == Place::passed_over ||
            (place_ == Place::data && !grammar_.data_stop.empty()))
            return wrong("the message ends within a segment");
        if (segments_.empty()) return Error{"has no segment"};
        for (const Segment& segment : segments_)
            if (segment.data.empty()) return at_line(segment.line, "a segment without data");
        return std::move(segments_);
    }

  private:
    enum class Place : std::uint8_t { header, metadata, between, data, passed_over };
    static constexpr std::size_t line_shown_max = 40;

    Error wrong(const std::string& what) const { return at_line(line_, what); }

    Result<void> begin_segment() {
        const bool open = place_ == Place::metadata || place_ == Place::between ||
                          (place_ == Place::data && !grammar_.data_stop.empty());
        if (open || !version_) return wrong("META_START where no segment may begin");
        segments_.emplace_back().line = line_;
        place_ = Place::metadata;
        return {};
    }

    Result<void> end_metadata() {
        if (place_ != Place::metadata) return wrong("META_STOP without META_START");
        Segment& segment = segments_.back();
        for (const std::string_view key : grammar_.needed)
            if (!segment.metadata.contains(key)) return wrong("the segment has no " + std::string(key));
        const auto system = time_system_named(segment.metadata.find("TIME_SYSTEM")->second);
        if (!system)
            return wrong("TIME_SYSTEM " + segment.metadata.find("TIME_SYSTEM")->second +
                         " is not read (UTC, TAI, TT, TDB and GPS are)");
        segment.system = *system;
        place_ = grammar_.data_start.empty() ? Place::data : Place::between;
        return {};
    }

    Result<void> keyword(std::string_view key, std::string_view value) {
        if (!version_) {
            if (key != grammar_.version_key)
                return wrong("the message begins with " + std::string(key) + ", not " +
                             std::string(grammar_.version_key));
            if (!grammar_.versions.contains(value)) return wrong("version " + std::string(value) + " is not read");
            version_ = true;
            return {};
        }
        if (place_ == Place::header) {
            constexpr std::array header{"CREATION_DATE", "ORIGINATOR", "MESSAGE_ID", "CLASSIFICATION"};
            if (std::ranges::find(header, key) == header.end())
                return wrong("keyword " + std::string(key) + " is not known in a header");
            return {};
        }
        if (place_ != Place::metadata) return wrong("keyword " + std::string(key) + " among data");
        if (!grammar_.metadata.contains(key)) return wrong("keyword " + std::string(key) + " is not known");
        if (value.empty()) return wrong("keyword " + std::string(key) + " has no value");
        if (!segments_.back().metadata.emplace(key, value).second)
            return wrong("keyword " + std::string(key) + " stands twice in a segment");
        return {};
    }

    Result<void> data(std::string_view line) {
        Segment& segment = segments_.back();
        const auto words = words_of(line);
        const auto time = ephemeris_time_from_text(words.front(), segment.system);
        if (!time) return wrong("'" + std::string(words.front()) + "' is no instant");
        if (!segment.data.empty() && !(*time > segment.data.back().time))
            return wrong("the instant is not after the one before it");
        DataLine row{line_, *time, {}};
        for (const std::string_view word : std::span{words}.subspan(1)) {
            double number = 0.0;
            const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
            if (error != std::errc{} || end != word.data() + word.size() || !(number - number == 0.0))
                return wrong("'" + std::string(word) + "' is no number");
            row.numbers.push_back(number);
        }
        segment.data.push_back(std::move(row));
        return {};
    }

    const Grammar& grammar_;
    std::size_t line_ = 0;
    bool version_ = false;
    Place place_ = Place::header;
    std::vector<Segment> segments_;
};

Result<std::vector<Segment>> segments_of(std::string_view text, const Grammar& grammar) {
    MessageReader reader{grammar};
    while (!text.empty()) {
        const auto end = std::min(text.find('\n'), text.size());
        if (const auto taken = reader.take(text.substr(0, end)); !taken) return taken.error();
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return reader.finish();
}

/// The value, or the empty text.
std::string value_of(const Metadata& metadata, std::string_view key) {
    const auto found = metadata.find(key);
    return found == metadata.end() ? "" : found->second;
}

/// What may be used of a segment: USEABLE_… where it is given, never beyond the data.
Result<std::pair<EphemerisTime, EphemerisTime>> span_of(const Segment& segment) {
    std::pair span{segment.data.front().time, segment.data.back().time};
    for (const bool stop : {false, true}) {
        const std::string_view key = stop ? "USEABLE_STOP_TIME" : "USEABLE_START_TIME";
        const std::string text = value_of(segment.metadata, key);
        if (text.empty()) continue;
        const auto time = ephemeris_time_from_text(text, segment.system);
        if (!time) return at_line(segment.line, std::string(key) + " '" + text + "' is no instant");
        if (stop)
            span.second = std::min(span.second, *time);
        else
            span.first = std::max(span.first, *time);
    }
    if (span.second < span.first) return at_line(segment.line, "the segment may be used at no instant");
    return span;
}

Result<std::size_t> degree_of(const Segment& segment, std::size_t otherwise) {
    const std::string text = value_of(segment.metadata, "INTERPOLATION_DEGREE");
    if (text.empty()) return otherwise;
    std::size_t degree = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), degree);
    constexpr std::size_t degree_max = 27;
    if (error != std::errc{} || end != text.data() + text.size() || degree < 1 || degree > degree_max)
        return at_line(segment.line, "INTERPOLATION_DEGREE '" + text + "' is not 1 to 27");
    return degree;
}

const Grammar orbit_grammar{
    "CCSDS_OEM_VERS",
    {"1.0", "2.0", "3.0"},
    {"OBJECT_NAME", "OBJECT_ID", "CENTER_NAME", "REF_FRAME", "REF_FRAME_EPOCH", "TIME_SYSTEM", "START_TIME",
     "USEABLE_START_TIME", "USEABLE_STOP_TIME", "STOP_TIME", "INTERPOLATION", "INTERPOLATION_DEGREE"},
    {"OBJECT_NAME", "OBJECT_ID", "CENTER_NAME", "REF_FRAME", "TIME_SYSTEM", "START_TIME", "STOP_TIME"},
    "",
    "",
    "COVARIANCE"};

const Grammar attitude_grammar{"CCSDS_AEM_VERS",
                               {"1.0", "2.0"},
                               {"OBJECT_NAME", "OBJECT_ID", "CENTER_NAME", "REF_FRAME_A", "REF_FRAME_B", "ATTITUDE_DIR",
                                "TIME_SYSTEM", "START_TIME", "USEABLE_START_TIME", "USEABLE_STOP_TIME", "STOP_TIME",
                                "ATTITUDE_TYPE", "QUATERNION_TYPE", "EULER_ROT_SEQ", "RATE_FRAME", "ANGVEL_FRAME",
                                "INTERPOLATION_METHOD", "INTERPOLATION_DEGREE"},
                               {"OBJECT_NAME", "OBJECT_ID", "REF_FRAME_A", "REF_FRAME_B", "TIME_SYSTEM", "START_TIME",
                                "STOP_TIME", "ATTITUDE_TYPE"},
                               "DATA_START",
                               "DATA_STOP",
                               ""};

Result<Ephemeris> ephemeris_of(const Segment& segment) {
    Ephemeris ephemeris;
    ephemeris.object = value_of(segment.metadata, "OBJECT_NAME");
    ephemeris.object_id = value_of(segment.metadata, "OBJECT_ID");
    ephemeris.centre = value_of(segment.metadata, "CENTER_NAME");
    ephemeris.frame = value_of(segment.metadata, "REF_FRAME");
    const std::string method = value_of(segment.metadata, "INTERPOLATION");
    if (!method.empty() && method != "HERMITE" && method != "LAGRANGE" && method != "LINEAR")
        return at_line(segment.line, "INTERPOLATION " + method + " is not known");
    ephemeris.interpolation = method.empty() || method == "HERMITE" ? Interpolation::hermite : Interpolation::lagrange;
    constexpr std::size_t cubic = 3;  // where the message does not say: through two states and their velocities
    const auto degree = degree_of(segment, method == "LINEAR" ? 1 : cubic);
    if (!degree) return degree.error();
    ephemeris.degree = *degree;
    const auto span = span_of(segment);
    if (!span) return span.error();
    std::tie(ephemeris.start, ephemeris.stop) = *span;
    for (const DataLine& row : segment.data) {
        if (row.numbers.size() != 6 && row.numbers.size() != 9)
            return at_line(row.line,
                           "a state has 6 numbers, or 9 with acceleration, not " + std::to_string(row.numbers.size()));
        EphemerisState state{row.time, {}, {}};
        for (std::size_t axis = 0; axis < 3; ++axis) {
            state.position_km.at(axis) = row.numbers[axis];
            state.velocity_kmps.at(axis) = row.numbers[3 + axis];
        }
        ephemeris.states.push_back(state);
    }
    return ephemeris;
}

/// How the numbers of a data line are to be read.
struct AttitudeForm {
    bool scalar_first = false, from_b_to_a = false, with_rates = false;
};

Result<AttitudeForm> form_of(const Segment& segment, const AttitudeHistory& history) {
    AttitudeForm form;
    const auto wrong = [&](const std::string& what) { return at_line(segment.line, what); };
    const std::string type = value_of(segment.metadata, "ATTITUDE_TYPE");
    form.with_rates = type == "QUATERNION/RATE" || type == "QUATERNION/ANGVEL";
    if (type != "QUATERNION" && !form.with_rates)
        return wrong("ATTITUDE_TYPE " + type + " is not read (QUATERNION, QUATERNION/ANGVEL and QUATERNION/RATE are)");
    const std::string order = value_of(segment.metadata, "QUATERNION_TYPE");
    if (!order.empty() && order != "FIRST" && order != "LAST")
        return wrong("QUATERNION_TYPE " + order + " is not known");
    form.scalar_first = order == "FIRST";
    const std::string direction = value_of(segment.metadata, "ATTITUDE_DIR");
    if (!direction.empty() && direction != "A2B" && direction != "B2A")
        return wrong("ATTITUDE_DIR " + direction + " is not known");
    form.from_b_to_a = direction == "B2A";
    for (const std::string_view key : {"RATE_FRAME", "ANGVEL_FRAME"}) {
        const std::string frame = value_of(segment.metadata, key);
        if (form.with_rates && !frame.empty() && frame != "REF_FRAME_B" && frame != history.frame_b)
            return wrong(std::string(key) + " " + frame + " is not read: angular velocities are read in REF_FRAME_B");
    }
    return form;
}

Result<AttitudeHistory> attitude_of(const Segment& segment) {
    AttitudeHistory history;
    history.object = value_of(segment.metadata, "OBJECT_NAME");
    history.object_id = value_of(segment.metadata, "OBJECT_ID");
    history.centre = value_of(segment.metadata, "CENTER_NAME");
    history.frame_a = value_of(segment.metadata, "REF_FRAME_A");
    history.frame_b = value_of(segment.metadata, "REF_FRAME_B");
    const auto form = form_of(segment, history);
    if (!form) return form.error();
    const auto span = span_of(segment);
    if (!span) return span.error();
    std::tie(history.start, history.stop) = *span;
    const std::size_t wanted = form->with_rates ? 7 : 4;
    for (const DataLine& row : segment.data) {
        if (row.numbers.size() != wanted)
            return at_line(row.line, "the attitude has " + std::to_string(row.numbers.size()) + " numbers, not " +
                                         std::to_string(wanted));
        AttitudeState state{row.time, {}, std::nullopt};
        for (std::size_t i = 0; i < 4; ++i) state.q_BA.at(i) = row.numbers[form->scalar_first ? i : (i + 3) % 4];
        // The standard's quaternion turns the axes of A into those of B: as one that turns components, it is conjugate.
        if (!form->from_b_to_a)
            for (std::size_t i = 1; i < 4; ++i) state.q_BA.at(i) = -state.q_BA.at(i);
        double length = 0.0;
        for (const double part : state.q_BA) length += part * part;
        constexpr double off_unit_max = 0.02;  // printed with few digits; a quaternion of another length is none
        if (!(std::abs(length - 1.0) <= off_unit_max)) return at_line(row.line, "the quaternion is not of unit length");
        if (form->with_rates)
            state.w_AB_B_rps = std::array{row.numbers[4] * degree_as_rad, row.numbers[5] * degree_as_rad,
                                          row.numbers[6] * degree_as_rad};
        history.states.push_back(state);
    }
    return history;
}

std::string number_text(double value, int decimals) {
    std::array<char, 64> text{};
    std::snprintf(text.data(), text.size(), "%.*f", decimals, value);
    return text.data();
}

std::string head_of(std::string_view key, std::string_view version, const MessageHeader& header) {
    std::string text = std::string(key) + " = " + std::string(version) + "\n";
    if (!header.comment.empty()) text += "COMMENT " + header.comment + "\n";
    return text + "CREATION_DATE = " + calendar_text(header.created, TimeSystem::utc) +
           "\nORIGINATOR = " + header.originator + "\n";
}

}  // namespace

Result<std::vector<Ephemeris>> read_orbit_message(std::string_view text) {
    const auto segments = segments_of(text, orbit_grammar);
    if (!segments) return segments.error();
    std::vector<Ephemeris> all;
    for (const Segment& segment : *segments) {
        auto ephemeris = ephemeris_of(segment);
        if (!ephemeris) return ephemeris.error();
        all.push_back(std::move(*ephemeris));
    }
    return all;
}

Result<std::vector<AttitudeHistory>> read_attitude_message(std::string_view text) {
    const auto segments = segments_of(text, attitude_grammar);
    if (!segments) return segments.error();
    std::vector<AttitudeHistory> all;
    for (const Segment& segment : *segments) {
        auto history = attitude_of(segment);
        if (!history) return history.error();
        all.push_back(std::move(*history));
    }
    return all;
}

std::string orbit_message(const std::vector<Ephemeris>& segments, const MessageHeader& header) {
    constexpr int position_decimals = 6, velocity_decimals = 9;  // a millimetre, a micrometre a second
    std::string text = head_of("CCSDS_OEM_VERS", "2.0", header);
    for (const Ephemeris& segment : segments) {
        const auto instant = [](EphemerisTime time) { return calendar_text(time, TimeSystem::utc); };
        text += "\nMETA_START\nOBJECT_NAME = " + segment.object + "\nOBJECT_ID = " + segment.object_id +
                "\nCENTER_NAME = " + segment.centre + "\nREF_FRAME = " + segment.frame +
                "\nTIME_SYSTEM = UTC\nSTART_TIME = " + instant(segment.states.front().time) +
                "\nUSEABLE_START_TIME = " + instant(segment.start) + "\nUSEABLE_STOP_TIME = " + instant(segment.stop) +
                "\nSTOP_TIME = " + instant(segment.states.back().time) +
                "\nINTERPOLATION = " + (segment.interpolation == Interpolation::hermite ? "HERMITE" : "LAGRANGE") +
                "\nINTERPOLATION_DEGREE = " + std::to_string(segment.degree) + "\nMETA_STOP\n\n";
        for (const EphemerisState& state : segment.states) {
            text += instant(state.time);
            for (const double value : state.position_km) text += " " + number_text(value, position_decimals);
            for (const double value : state.velocity_kmps) text += " " + number_text(value, velocity_decimals);
            text += "\n";
        }
    }
    return text;
}

std::string attitude_message(const std::vector<AttitudeHistory>& segments, const MessageHeader& header) {
    constexpr int quaternion_decimals = 10, rate_decimals = 8;
    std::string text = head_of("CCSDS_AEM_VERS", "2.0", header);
    for (const AttitudeHistory& segment : segments) {
        const auto instant = [](EphemerisTime time) { return calendar_text(time, TimeSystem::utc); };
        const bool rates =
            std::ranges::all_of(segment.states, [](const auto& state) { return state.w_AB_B_rps.has_value(); });
        text += "\nMETA_START\nOBJECT_NAME = " + segment.object + "\nOBJECT_ID = " + segment.object_id +
                "\nCENTER_NAME = " + segment.centre + "\nREF_FRAME_A = " + segment.frame_a +
                "\nREF_FRAME_B = " + segment.frame_b +
                "\nTIME_SYSTEM = UTC\nSTART_TIME = " + instant(segment.states.front().time) +
                "\nSTOP_TIME = " + instant(segment.states.back().time) +
                "\nATTITUDE_TYPE = " + (rates ? "QUATERNION/ANGVEL\nANGVEL_FRAME = REF_FRAME_B" : "QUATERNION") +
                "\nMETA_STOP\n\nDATA_START\n";
        for (const AttitudeState& state : segment.states) {
            text += instant(state.time);
            for (const std::size_t i : {1U, 2U, 3U, 0U})
                text += " " + number_text(i == 0 ? state.q_BA.at(i) : -state.q_BA.at(i), quaternion_decimals);
            if (rates)
                for (const double rate : *state.w_AB_B_rps)
                    text += " " + number_text(rate / degree_as_rad, rate_decimals);
            text += "\n";
        }
        text += "DATA_STOP\n";
    }
    return text;
}

}  // namespace aeolis
