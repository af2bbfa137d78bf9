// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/yaml_document.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <utility>
#include <yaml.h>

namespace aeolis::server::procedures {
namespace {

Mark mark_of(const yaml_mark_t& mark) {
    return {static_cast<unsigned>(mark.line + 1), static_cast<unsigned>(mark.column + 1)};
}

/// The place of an octet that is no UTF-8, for which libyaml knows no line.
Mark mark_at(std::string_view text, std::size_t octet) {
    Mark mark;
    for (std::size_t i = 0; i < std::min(octet, text.size()); ++i) {
        const auto c = static_cast<unsigned char>(text[i]);
        if (c == '\n')
            mark = {mark.line + 1, 1};
        else if ((c & 0xC0U) != 0x80U)
            ++mark.column;
    }
    return mark;
}

std::string text_of(const yaml_char_t* octets, std::size_t size) {
    return {reinterpret_cast<const char*>(octets), size};
}

/// A token of the parser, freed with it.
class YamlEvent {
  public:
    YamlEvent() = default;
    YamlEvent(const YamlEvent&) = delete;
    YamlEvent& operator=(const YamlEvent&) = delete;
    ~YamlEvent() { yaml_event_delete(&event_); }

    yaml_event_t* get() { return &event_; }
    const yaml_event_t* operator->() const { return &event_; }

  private:
    yaml_event_t event_{};
};

class YamlReader {
  public:
    YamlReader(std::string_view text, const std::string& file) : text_(text), file_(file) {
        yaml_parser_initialize(&parser_);
        yaml_parser_set_encoding(&parser_, YAML_UTF8_ENCODING);
        yaml_parser_set_input_string(&parser_, reinterpret_cast<const unsigned char*>(text.data()), text.size());
    }
    YamlReader(const YamlReader&) = delete;
    YamlReader& operator=(const YamlReader&) = delete;
    ~YamlReader() { yaml_parser_delete(&parser_); }

    YamlDocument read() {
        while (!ended_ && next()) {
        }
        if (!ended_) document_.root.reset();
        return std::move(document_);
    }

  private:
    /// A list or table that is not closed yet. Its node is filled here and moved up at its end, so that no pointer into
    /// a growing vector is kept.
    struct Open {
        YamlNode node;
        std::optional<YamlNode::Key> key;  ///< of a mapping: read, its value not yet
        bool skip = false;                 ///< the key stood before: its value is read and dropped
    };

    bool refuse(Mark mark, std::string message) {
        document_.findings.push_back({file_, mark, std::move(message)});
        return false;
    }

    bool syntax_error() {
        if (parser_.error == YAML_READER_ERROR)
            return refuse(mark_at(text_, parser_.problem_offset), fmt::format("no text in UTF-8: {}", parser_.problem));
        const std::string problem = parser_.problem == nullptr ? "cannot be read" : parser_.problem;
        return refuse(mark_of(parser_.problem_mark), parser_.context == nullptr
                                                         ? "no YAML: " + problem
                                                         : fmt::format("no YAML: {}, {}", problem, parser_.context));
    }

    bool next() {
        YamlEvent event;
        if (yaml_parser_parse(&parser_, event.get()) == 0) return syntax_error();
        const Mark mark = mark_of(event->start_mark);
        switch (event->type) {
        case YAML_NO_EVENT:
        case YAML_STREAM_START_EVENT:
        case YAML_DOCUMENT_END_EVENT: return true;
        case YAML_STREAM_END_EVENT: ended_ = true; return true;
        case YAML_DOCUMENT_START_EVENT:
            return !document_.root || refuse(mark, "a second document begins; a file holds one");
        case YAML_ALIAS_EVENT: return refuse(mark, "an alias (*) stands here; write out what it stands for");
        case YAML_SCALAR_EVENT: {
            const auto& scalar = event->data.scalar;
            if (!without_extras(mark, scalar.anchor, scalar.tag)) return false;
            return put({.kind = YamlNode::Kind::scalar,
                        .mark = mark,
                        .text = text_of(scalar.value, scalar.length),
                        .plain = scalar.style == YAML_PLAIN_SCALAR_STYLE});
        }
        case YAML_SEQUENCE_START_EVENT: {
            const auto& start = event->data.sequence_start;
            return without_extras(mark, start.anchor, start.tag) && open(YamlNode::Kind::sequence, mark);
        }
        case YAML_MAPPING_START_EVENT: {
            const auto& start = event->data.mapping_start;
            return without_extras(mark, start.anchor, start.tag) && open(YamlNode::Kind::mapping, mark);
        }
        case YAML_SEQUENCE_END_EVENT:
        case YAML_MAPPING_END_EVENT: {
            YamlNode closed = std::move(open_.back().node);
            open_.pop_back();
            return put(std::move(closed));
        }
        }
        return true;
    }

    bool without_extras(Mark mark, const yaml_char_t* anchor, const yaml_char_t* tag) {
        if (anchor != nullptr) return refuse(mark, "an anchor (&) stands here; a procedure has none");
        if (tag != nullptr) return refuse(mark, "a tag (!) stands here; a procedure has none");
        return true;
    }

    bool open(YamlNode::Kind kind, Mark mark) {
        if (open_.size() >= yaml_depth_max)
            return refuse(mark, fmt::format("nested deeper than {} levels", yaml_depth_max));
        if (!open_.empty() && open_.back().node.kind == YamlNode::Kind::mapping && !open_.back().key)
            return refuse(mark, "a list or table stands where a name is needed");
        Open begun;
        begun.node.kind = kind;
        begun.node.mark = mark;
        open_.push_back(std::move(begun));
        return true;
    }

    /// Puts a value that is whole into what holds it.
    bool put(YamlNode value) {
        if (++nodes_ > yaml_nodes_max) return refuse(value.mark, fmt::format("more than {} values", yaml_nodes_max));
        if (open_.empty()) {
            document_.root = std::move(value);
            return true;
        }
        Open& holder = open_.back();
        if (holder.node.kind == YamlNode::Kind::sequence) {
            holder.node.items.push_back(std::move(value));
            return true;
        }
        if (!holder.key) {
            if (holder.node.keys.size() >= yaml_names_max)
                return refuse(value.mark, fmt::format("more than {} names in one table", yaml_names_max));
            holder.skip = holder.node.member(value.text) != nullptr;
            if (holder.skip) refuse(value.mark, fmt::format("'{}' stands here a second time", value.text));
            holder.key = YamlNode::Key{std::move(value.text), value.mark};
            return true;
        }
        if (!holder.skip) {
            holder.node.keys.push_back(*std::move(holder.key));
            holder.node.items.push_back(std::move(value));
        }
        holder.key.reset();
        return true;
    }

    std::string_view text_;
    const std::string& file_;
    yaml_parser_t parser_{};
    std::vector<Open> open_;
    std::size_t nodes_ = 0;
    bool ended_ = false;
    YamlDocument document_;
};

}  // namespace

std::string TextFinding::text() const {
    return fmt::format("{}:{}:{}: {}", file, mark.line, mark.column, message);
}

const YamlNode* YamlNode::member(std::string_view name) const {
    for (std::size_t i = 0; i < keys.size(); ++i)
        if (keys[i].name == name) return &items[i];
    return nullptr;
}

YamlDocument read_yaml(std::string_view text, const std::string& file) {
    if (text.size() > yaml_octets_max)
        return {{}, {{file, {}, fmt::format("{} octets, more than {}", text.size(), yaml_octets_max)}}};
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    YamlDocument document = YamlReader{text, file}.read();
    if (!document.root && document.findings.empty()) document.findings.push_back({file, {}, "the file is empty"});
    return document;
}

}  // namespace aeolis::server::procedures
