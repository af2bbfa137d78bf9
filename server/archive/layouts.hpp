// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "server/archive/sqlite.hpp"

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

// Layouts of the console, by owner and name. Unlike all other rows they are replaced and removed, because they do not
// record a run. They are kept here because every server has an archive, but not every server has accounts.
namespace aeolis::archive {

inline constexpr std::size_t layouts_max = 32;               ///< chosen: of one owner; more are hard to choose from
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
/// The layouts of the owner, the one saved longest ago first.
Result<std::vector<LayoutRecord>> layouts_of(sqlite::Database& database, const std::string& owner);

}  // namespace aeolis::archive
