// SPDX-License-Identifier: Apache-2.0
#include "dictionaries/mission_files.hpp"

#include "dictionaries/xtce/document.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>

namespace aeolis::dictionary {
namespace {

constexpr std::uintmax_t file_octets_max = 16U << 20U;  // chosen: a hundred times the landing's largest file

constexpr std::string_view set_begins = "<AncillaryDataSet>\n";
constexpr std::string_view set_ends = "</AncillaryDataSet>\n    ";
/// Entry that holds the original name of the XTCE file, which findings refer to. It comes first.
constexpr std::string_view xtce_entry = "xtce";

MissionFile read_file(const std::filesystem::path& path, std::vector<Finding>& all) {
    MissionFile file{path.filename().string(), std::nullopt};
    Findings findings{file.name, all};
    std::error_code error;
    const std::uintmax_t octets = std::filesystem::file_size(path, error);
    std::ifstream in{path, std::ios::binary};
    if (error || !in)
        findings.add(1, "cannot be read: " + path.string());
    else if (octets > file_octets_max)
        findings.add(1, "is larger than " + std::to_string(file_octets_max) + " octets");
    else {
        file.text.emplace(octets, '\0');
        in.read(file.text->data(), static_cast<std::streamsize>(octets));
        file.text->resize(static_cast<std::size_t>(in.gcount()));
    }
    return file;
}

/// The one XTCE file of the folder.
MissionFile read_xtce(const std::filesystem::path& directory, std::vector<Finding>& all) {
    std::vector<std::filesystem::path> found;
    std::error_code error;
    for (std::filesystem::directory_iterator entry{directory, error}, end; !error && entry != end;
         entry.increment(error))
        if (entry->path().extension() == ".xml") found.push_back(entry->path());
    if (found.size() == 1) return read_file(found.front(), all);
    std::ranges::sort(found);
    const std::string name = found.empty() ? directory.filename().string() : found[1].filename().string();
    Findings{name, all}.add(1, found.empty() ? "there is no XTCE file (*.xml) in " + directory.string()
                                             : "a second XTCE file beside " + found[0].filename().string());
    return {name, std::nullopt};
}

std::optional<std::string> escaped(std::string_view text) {
    std::string escaped;
    for (const char c : text) {
        const auto octet = static_cast<unsigned char>(c);
        if (octet < ' ' && c != '\t' && c != '\n' && c != '\r') return std::nullopt;
        if (c == '&')
            escaped += "&amp;";
        else if (c == '<')
            escaped += "&lt;";
        else if (c == '>')
            escaped += "&gt;";
        else if (c == '\r')
            escaped += "&#13;";
        else
            escaped += c;
    }
    return escaped;
}

/// Position of the sheets: before the first element that the schema places after ancillary data.
pugi::xml_node place_of_sheets(pugi::xml_node system) {
    for (const pugi::xml_node child : system.children()) {
        const std::string_view name = child.name();
        if (child.type() == pugi::node_element && name != "LongDescription" && name != "AliasSet") return child;
    }
    return {};
}

/// Offset of the "<" of an element.
std::size_t beginning_of(pugi::xml_node element) {
    return static_cast<std::size_t>(element.offset_debug()) - 1;
}

MissionFiles take_apart(MissionFile whole, std::vector<Finding>& all) {
    MissionFiles files;
    Findings findings{whole.name, all};
    const auto refused = [&](const std::string& why) {
        findings.add(1, why);
        files.xtce = {whole.name, std::nullopt};
        for (const auto name : MissionFiles::sheet_names) files.sheets.push_back({std::string{name}, std::nullopt});
        return files;
    };
    const auto document = xtce::Document::parse(*whole.text, findings);
    if (!document) return refused("is no XTCE");
    const pugi::xml_node set = place_of_sheets(document->space_system());
    const std::size_t begin = set ? beginning_of(set) : 0;
    const std::size_t end = whole.text->find(set_ends, begin);
    if (std::string_view{set.name()} != "AncillaryDataSet" || end == std::string::npos ||
        whole.text->compare(begin, set_begins.size(), set_begins) != 0)
        return refused("holds no sheets: a mission's folder, or what 'aeolis dictionary export' wrote, is wanted");
    for (const auto name : MissionFiles::sheet_names) {
        const pugi::xml_node data = set.find_child_by_attribute("AncillaryData", "name", std::string{name}.c_str());
        MissionFile& sheet = files.sheets.emplace_back(MissionFile{std::string{name}, std::nullopt});
        if (data)
            sheet.text = data.child_value();
        else
            Findings{sheet.name, all}.add(1, "is not in " + whole.name);
    }
    files.xtce.name =
        set.find_child_by_attribute("AncillaryData", "name", std::string{xtce_entry}.c_str()).child_value();
    files.xtce.text = whole.text->erase(begin, end + set_ends.size() - begin);
    return files;
}

}  // namespace

const MissionFile& MissionFiles::sheet(std::string_view name) const {
    const auto found = std::ranges::find(sheets, name, &MissionFile::name);
    AEOLIS_CHECK(found != sheets.end());
    return *found;
}

MissionFiles read_mission_files(const std::filesystem::path& path, std::vector<Finding>& all) {
    std::error_code error;
    if (std::filesystem::is_regular_file(path, error)) {
        MissionFile whole = read_file(path, all);
        if (whole.text) return take_apart(std::move(whole), all);
    }
    MissionFiles files;
    files.xtce = read_xtce(path, all);
    for (const auto name : MissionFiles::sheet_names) files.sheets.push_back(read_file(path / name, all));
    return files;
}

Result<std::string> one_file_of(const MissionFiles& files) {
    if (!files.xtce.text) return Error{files.xtce.name + " has not been read"};
    std::vector<Finding> found;
    Findings findings{files.xtce.name, found};
    const auto document = xtce::Document::parse(*files.xtce.text, findings);
    if (!document) return Error{found.front().text()};
    const pugi::xml_node place = place_of_sheets(document->space_system());
    if (!place || std::string_view{place.name()} == "AncillaryDataSet" ||
        files.xtce.text->compare(beginning_of(document->space_system()), 12, "<SpaceSystem") != 0)
        return Error{files.xtce.name + ":1: its SpaceSystem is empty, has a prefix, or has ancillary data of its own: "
                                       "there is no place for the sheets"};
    std::string set{set_begins};
    const auto add = [&](std::string_view name, const std::string& text) {
        set += "        <AncillaryData name=\"" + std::string{name} + "\" mimeType=\"text/csv\">" + text +
               "</AncillaryData>\n";
    };
    add(xtce_entry, files.xtce.name);
    for (const MissionFile& sheet : files.sheets) {
        const auto text = sheet.text ? escaped(*sheet.text) : std::nullopt;
        if (!text) return Error{sheet.name + " is missing, or holds an octet that XML cannot"};
        add(sheet.name, *text);
    }
    std::string whole = *files.xtce.text;
    return whole.insert(beginning_of(place), set + "    " + std::string{set_ends});
}

}  // namespace aeolis::dictionary
