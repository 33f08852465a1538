#pragma once
// A piece of work in one transaction, begun again when another was first.

#include <functional>

#include "database.hpp"

namespace elrom::repository {

/// @throws SystemError when it lost again and again; what `work` throws, after which nothing of it is kept
void transact(Connection& connection, bool writes, const std::function<void()>& work);

}  // namespace elrom::repository
