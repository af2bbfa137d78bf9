// SPDX-License-Identifier: Apache-2.0
#include "flight/kernel/message.hpp"

#include "flight/kernel/only_data.hpp"

namespace aeolis::flight {

template void expect_only_data_in_each(Message&);

}  // namespace aeolis::flight
