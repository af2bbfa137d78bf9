// SPDX-License-Identifier: Apache-2.0
#include "server/procedures/call_list.hpp"

#include "server/procedures/form_reader.hpp"
#include "server/procedures/yaml_document.hpp"

#include <algorithm>
#include <array>
#include <set>

namespace aeolis::server::procedures {
namespace {

constexpr std::size_t calls_max = 36;        ///< as many as there are keys
constexpr double read_back_s_max = 3'600.0;  ///< chosen

bool is_key(const std::string& text) {
    return text.size() == 1 && ((text[0] >= 'a' && text[0] <= 'z') || (text[0] >= '0' && text[0] <= '9'));
}

class CallReader : public FormReader {
  public:
    explicit CallReader(const std::string& file) : FormReader(file) {}

    ReadCalls read(std::string_view text);

  private:
    StandardCall call(const YamlNode& node);
    std::string short_words(const YamlNode& node, std::string_view name);

    std::set<std::string> said_;
    std::set<char> keys_;
};

std::string CallReader::short_words(const YamlNode& node, std::string_view name) {
    const YamlNode* given = node.member(name);
    if (given == nullptr) return {};
    auto text = words(*given, name);
    if (text.size() > says_characters_max)
        add(given->mark, fmt::format("{} has {} octets, at most {}", name, text.size(), says_characters_max));
    if (text.find('\n') != std::string::npos) add(given->mark, fmt::format("{} has more than one line", name));
    return text;
}

StandardCall CallReader::call(const YamlNode& node) {
    static constexpr std::array must{std::string_view{"call"}, std::string_view{"key"}, std::string_view{"says"}};
    static constexpr std::array may{std::string_view{"asks"}};
    StandardCall read;
    if (!table(node, "a call", must, may)) return read;
    if (const YamlNode* given = node.member("call")) read.id = id(*given, "a call");
    if (const YamlNode* given = node.member("key")) {
        const auto text = words(*given, "'key'");
        if (!text.empty() && !is_key(text))
            add(given->mark, fmt::format("'{}' is no key: a small letter or a digit", text));
        else if (!text.empty() && !keys_.insert(text[0]).second)
            add(given->mark, fmt::format("the key '{}' is another call's, too", text));
        else if (!text.empty())
            read.key = text[0];
    }
    read.says = short_words(node, "says");
    if (!read.says.empty() && !said_.insert(read.says).second)
        add(node.member("says")->mark, fmt::format("another call says '{}', too", read.says));
    read.asks = short_words(node, "asks");
    return read;
}

ReadCalls CallReader::read(std::string_view text) {
    static constexpr std::array must{std::string_view{"calls"}, std::string_view{"source"},
                                     std::string_view{"read_back_s"}, std::string_view{"list"}};
    auto document = read_yaml(text, file_);
    findings_ = std::move(document.findings);
    CallList read;
    if (document.root && table(*document.root, "a list of calls", must, {})) {
        const YamlNode& root = *document.root;
        static_cast<void>(id_of_file(root, "calls"));
        static_cast<void>(words(root, "source", "'source'"));
        if (const YamlNode* given = root.member("read_back_s"))
            read.read_back_s = number(*given, "read_back_s", 1.0, read_back_s_max, " s").value_or(0.0);
        for (const YamlNode& item : list(root.member("list"), "'list'", calls_max)) read.calls.push_back(call(item));
    }
    if (findings_.empty() && document.root) return {std::move(read), {}};
    return {std::nullopt, all_findings()};
}

}  // namespace

const StandardCall* CallList::call(std::string_view id) const {
    const auto found = std::ranges::find(calls, id, &StandardCall::id);
    return found == calls.end() ? nullptr : &*found;
}

ReadCalls read_calls(std::string_view text, const std::string& file) {
    return CallReader{file}.read(text);
}

}  // namespace aeolis::server::procedures
