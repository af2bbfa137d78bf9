// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/archive/sqlite.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

// Layouts of the console, by owner and name. Unlike all other rows they are replaced and removed: they are no record of
// a run. They are kept here since every server has an archive, and not every one has accounts.
namespace aeolis::archive {

inline constexpr std::size_t layouts_max = 32;               ///< chosen: of one owner; more is no choice but a search
inline constexpr std::size_t layout_name_octets_max = 40;    ///< chosen: fits a line of the console's menu
inline constexpr std::size_t layout_view_octets_max = 2048;  ///< chosen: sixteen plots of three channels each

struct LayoutRecord {
    std::string name;
    std::string view;   ///< as in the console's address
    std::string saved;  ///< wall clock, ISO 8601
};

/// Checks the name and the view of a layout to be saved. The Error names the field.
Result<void> check_layout_name(const std::string& name);
Result<void> check_layout_view(const std::string& view);

/// Saves a layout under its name, or removes the one of that name.
struct LayoutChange {
    std::string owner;  ///< user, "token NAME", or empty: everyone, on a server without accounts
    std::string name;
    std::optional<std::string> view;  ///< none: remove it
    std::string saved;
};
enum class LayoutOutcome : std::uint8_t {
    done,
    absent,  ///< there was none to remove
    full,    ///< the owner has layouts_max others
};

/// Call within a transaction.
Result<LayoutOutcome> change_layout(sqlite::Database& database, const LayoutChange& change);
/// The layouts of the owner, the one saved first before the others.
Result<std::vector<LayoutRecord>> layouts_of(sqlite::Database& database, const std::string& owner);

}  // namespace aeolis::archive
