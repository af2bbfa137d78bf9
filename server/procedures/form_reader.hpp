// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/names.hpp"
#include "server/procedures/procedure.hpp"

#include <fmt/format.h>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace aeolis::server::procedures {

/// "'capten' is no position; the nearest name is 'command'"
template <typename All, typename NameOf>
std::string unknown_name(std::string_view name, std::string_view what, const All& all, NameOf name_of_one) {
    const auto like = nearest(name, all, name_of_one);
    return like.empty() ? fmt::format("'{}' is no {}", name, what)
                        : fmt::format("'{}' is no {}; the nearest name is '{}'", name, what, like);
}

inline constexpr std::size_t findings_max = 100;  ///< of one file; more are a file of another kind

/// Reads the words of a form: texts, numbers, days, positions, times. What is wrong becomes a finding with its place,
/// and reading goes on.
class FormReader {
  public:
    /// @param file  its name in findings; must outlive this object
    explicit FormReader(const std::string& file) : file_(file) {}

  protected:
    void add(Mark mark, std::string message) { findings_.push_back({file_, mark, std::move(message)}); }

    bool is(const YamlNode& node, YamlNode::Kind kind, std::string_view what);
    /// Reports names that the form does not have, and those it must have.
    bool table(const YamlNode& node, std::string_view what, std::span<const std::string_view> must,
               std::span<const std::string_view> may);
    std::string words(const YamlNode& node, std::string_view what);
    /// The words of a member; empty where there is none.
    std::string words(const YamlNode& node, std::string_view name, std::string_view what);
    std::optional<double> number(const YamlNode& node, std::string_view what, double least, double most,
                                 std::string_view unit);
    std::optional<bool> yes_or_no(const YamlNode& node, std::string_view what);
    /// The member `on`.
    std::string date(const YamlNode& node, std::string_view what);
    std::optional<Position> position(const YamlNode& node);
    Position position_of(const YamlNode& table, std::string_view name);
    std::optional<EntryTime> entry_time(const YamlNode& node);
    /// The items of a list, at most `most`.
    std::span<const YamlNode> list(const YamlNode* node, std::string_view what, std::size_t most);
    /// An id, which stands once in the text; `reserved` have another meaning.
    std::string id(const YamlNode& node, std::string_view what, std::span<const std::string_view> reserved = {});
    /// The document's id: the name of its file, without folder and ending. Of a text that is in no file, any.
    std::string id_of_file(const YamlNode& root, std::string_view what);
    /// What was found, in the order of the text, findings_max at most.
    std::vector<TextFinding> all_findings();

    const std::string& file_;
    std::vector<TextFinding> findings_;

  private:
    std::map<std::string, Mark> ids_;
};

}  // namespace aeolis::server::procedures
