# SPDX-License-Identifier: Apache-2.0
# Run by cpack before packing. The service's user must be able to enter the folders, whatever the umask of the builder.
file(CHMOD_RECURSE ${CPACK_TEMPORARY_INSTALL_DIRECTORY}
    DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
