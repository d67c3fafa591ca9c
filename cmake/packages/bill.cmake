# SPDX-License-Identifier: Apache-2.0
# Run by cpack when the packages are made: writes the list of what they are and stand on beside them.
execute_process(COMMAND "${CMAKE_CURRENT_LIST_DIR}/bill.py" --output "${CPACK_PACKAGE_DIRECTORY}" ${CPACK_PACKAGE_FILES}
                COMMAND_ERROR_IS_FATAL ANY)
