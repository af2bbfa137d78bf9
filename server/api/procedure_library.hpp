// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "aeolis/v1/procedures.pb.h"
#include "common/result.hpp"
#include "dictionaries/dictionary.hpp"
#include "server/procedures/procedure_reader.hpp"

#include <filesystem>
#include <string>
#include <utility>

namespace aeolis::server {

/// The procedures of a mission: the files in a folder. Read anew for each call.
class ProcedureLibrary {
  public:
    /// @param folder  empty: there are none
    explicit ProcedureLibrary(std::filesystem::path folder = {}) : folder_(std::move(folder)) {}

    /// All by id, those with findings too.
    v1::ProcedureList list(const dictionary::Dictionary& dictionary) const;

    struct Found {
        std::string text;  ///< of the file
        procedures::ReadProcedure read;

        std::string findings_text() const;  ///< a line each
    };
    /// The Error of an unknown id lists those that exist.
    Result<Found> procedure(const std::string& id, const dictionary::Dictionary& dictionary) const;

  private:
    std::filesystem::path folder_;
};

/// Reads a file, whose watchdogs may name the procedures that lie beside it. An Error when there is no such file.
/// @param name  of the file in findings
Result<ProcedureLibrary::Found> read_procedure_file(const std::filesystem::path& file, const std::string& name,
                                                    const dictionary::Dictionary& dictionary);

}  // namespace aeolis::server
