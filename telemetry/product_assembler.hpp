// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "dictionaries/dictionary.hpp"
#include "telemetry/decommutator.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace aeolis::telemetry {

/// The identity of a data product in its run. A computer numbers its products from 1, and again after a reset, so size
/// and CRC are part of the identity.
struct ProductIdentity {
    std::uint16_t id = 0;
    std::uint16_t crc = 0;
    std::uint32_t octets = 0;
    constexpr auto operator<=>(const ProductIdentity&) const = default;
};

/// One part of a product, from a packet of the container "DataProduct".
struct ProductPart {
    ProductIdentity product;
    std::string kind;  ///< label: "as_flown"
    Apid row_apid;     ///< of the packet whose data field each row is
    std::uint16_t part = 0, parts = 0;
    std::vector<std::uint8_t> content;  ///< without the last part's padding
};

/// Reads a part of a product. None when the packet is not such a part, or when its numbers disagree. `packet`: the
/// octets from which `decoded` was made.
std::optional<ProductPart> part_of(const dictionary::Dictionary& dictionary, const Decoded& decoded,
                                   std::span<const std::uint8_t> packet);

/// A product of which at least one part was received.
struct Product {
    std::string kind;
    Apid row_apid;
    std::uint16_t parts = 0;
    std::vector<std::optional<std::vector<std::uint8_t>>> received;  ///< by part, from 0

    /// The whole content; none while parts are missing or when its CRC is wrong.
    std::optional<std::vector<std::uint8_t>> content(const ProductIdentity& identity) const;

    /// The missing parts: "3-5, 9"; empty: none.
    std::string gaps() const;
};

enum class PartStanding : std::uint8_t {
    taken,
    again,    ///< repeated with equal octets
    differs,  ///< octets, kind or number of parts differ from those received: not taken
    refused,  ///< memory is full
};

/// Assembles data products from parts in any order, real time and recording mixed. R30
///
/// In       parts of one run                 Out   products, whole or with their gaps named
/// Memory   the octets of the products, at most `octets_max` together; a part beyond that is refused
class ProductAssembler {
  public:
    static constexpr std::size_t octets_max_default = std::size_t{16}
                                                      << 20;  ///< chosen: hundreds of a landing's products

    explicit ProductAssembler(std::size_t octets_max = octets_max_default) : octets_max_(octets_max) {}

    PartStanding add(const ProductPart& part);
    const std::map<ProductIdentity, Product>& products() const { return products_; }

  private:
    std::size_t octets_max_;
    std::size_t octets_ = 0;
    std::map<ProductIdentity, Product> products_;
};

/// "as_flown 1, 1292 octets: whole" or "imu_burst 2, 22400 octets: parts 3-5, 9 of 98 are missing".
std::string text_of(const ProductIdentity& identity, const Product& product);

/// The rows of a whole product's content as packets of their container, for the decommutator. None when the dictionary
/// lacks the container, or the content is not a whole number of rows.
std::optional<std::vector<std::vector<std::uint8_t>>> rows_of(const dictionary::Dictionary& dictionary, Apid row_apid,
                                                              std::span<const std::uint8_t> content);

/// The rows in a packet that holds a table (it has fields row_apid and table_rows, and content). None when it is not
/// such a packet, or when its numbers disagree. `packet`: the octets from which `decoded` was made.
std::optional<std::vector<std::vector<std::uint8_t>>>
rows_in(const dictionary::Dictionary& dictionary, const Decoded& decoded, std::span<const std::uint8_t> packet);

}  // namespace aeolis::telemetry
