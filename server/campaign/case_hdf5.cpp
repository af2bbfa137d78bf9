// SPDX-License-Identifier: Apache-2.0
#include "server/campaign/case_hdf5.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <hdf5.h>
#include <utility>

namespace aeolis::server::campaign {
namespace {

/// Something of HDF5's that is closed in time.
class Handle {
  public:
    using Close = herr_t (*)(hid_t);
    Handle(hid_t id, Close close) : id_(id), close_(close) {}
    Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, H5I_INVALID_HID)), close_(other.close_) {}
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle() {
        if (id_ >= 0) close_(id_);
    }
    explicit operator bool() const { return id_ >= 0; }
    hid_t id() const { return id_; }

  private:
    hid_t id_;
    Close close_;
};

Error refused(std::string_view what) {
    return Error{fmt::format("HDF5 could not write {}", what)};
}

/// Text of a fixed number of octets, at least one: HDF5 has no empty text.
Handle text_type(std::size_t octets) {
    Handle type{H5Tcopy(H5T_C_S1), H5Tclose};
    H5Tset_size(type.id(), std::max<std::size_t>(octets, 1));
    H5Tset_cset(type.id(), H5T_CSET_UTF8);
    H5Tset_strpad(type.id(), H5T_STR_NULLPAD);
    return type;
}

bool set_attribute(hid_t of, const char* name, hid_t type, const void* value) {
    const Handle space{H5Screate(H5S_SCALAR), H5Sclose};
    const Handle attribute{H5Acreate2(of, name, type, space.id(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose};
    return attribute && H5Awrite(attribute.id(), type, value) >= 0;
}

bool set_text_attribute(hid_t of, const char* name, const std::string& text) {
    return set_attribute(of, name, text_type(text.size()).id(), text.c_str());
}

/// A dataset with a value a case.
bool put_column(hid_t group, const std::string& name, hid_t type, hsize_t cases, const void* values) {
    const Handle made{H5Pcreate(H5P_DATASET_CREATE), H5Pclose};
    H5Pset_obj_track_times(made.id(), false);  // or no two files would be alike
    const Handle space{H5Screate_simple(1, &cases, nullptr), H5Sclose};
    const Handle set{H5Dcreate2(group, name.c_str(), type, space.id(), H5P_DEFAULT, made.id(), H5P_DEFAULT), H5Dclose};
    return set && (cases == 0 || H5Dwrite(set.id(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
}

bool put_outcomes(hid_t group, const std::vector<std::string>& outcomes) {
    std::size_t longest = 1;
    for (const auto& each : outcomes) longest = std::max(longest, each.size());
    std::string padded;
    for (auto each : outcomes) {
        each.resize(longest, '\0');
        padded += each;
    }
    return put_column(group, "outcome", text_type(longest).id(), outcomes.size(), padded.data());
}

/// The group `cases`; its datasets keep their order.
Handle make_group(hid_t file) {
    const Handle made{H5Pcreate(H5P_GROUP_CREATE), H5Pclose};
    H5Pset_link_creation_order(made.id(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED);
    H5Pset_obj_track_times(made.id(), false);
    return {H5Gcreate2(file, "cases", H5P_DEFAULT, made.id(), H5P_DEFAULT), H5Gclose};
}

Result<std::string> octets_of(hid_t file) {
    H5Fflush(file, H5F_SCOPE_GLOBAL);
    const auto size = H5Fget_file_image(file, nullptr, 0);
    if (size <= 0) return refused("the file");
    std::string octets(static_cast<std::size_t>(size), '\0');
    if (H5Fget_file_image(file, octets.data(), octets.size()) != size) return refused("the file");
    return octets;
}

}  // namespace

Result<std::string> hdf5_of(const CaseTable& table, const TableOrigin& origin) {
    constexpr std::size_t grows_by_octets = 1 << 20;
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // it would print for itself
    const Handle access{H5Pcreate(H5P_FILE_ACCESS), H5Pclose};
    H5Pset_fapl_core(access.id(), grows_by_octets, false);  // in memory alone
    const Handle file{H5Fcreate("cases.h5", H5F_ACC_TRUNC, H5P_DEFAULT, access.id()), H5Fclose};
    if (!file) return refused("a file");
    if (!set_text_attribute(file.id(), "scenario", origin.scenario) ||
        !set_attribute(file.id(), "seed", H5T_NATIVE_UINT64, &origin.seed))
        return refused("the attributes");
    const Handle group = make_group(file.id());
    if (!group) return refused("the group 'cases'");
    const hsize_t cases = table.numbers.size();
    if (!put_column(group.id(), "number", H5T_NATIVE_UINT64, cases, table.numbers.data())) return refused("'number'");
    if (!put_outcomes(group.id(), table.outcomes)) return refused("'outcome'");
    for (const auto& [name, values] : table.columns)
        if (!put_column(group.id(), name, H5T_NATIVE_DOUBLE, cases, values.data()))
            return refused(fmt::format("'{}'", name));
    return octets_of(file.id());
}

}  // namespace aeolis::server::campaign
