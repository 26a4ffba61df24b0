"""A window whose dialogs are opened one after the other, to be read."""


def dialogs(driver):
    """The settings, and the dialogs of studies."""
    window = driver.window
    window.settings_page.open()
    show(driver, "settings", window.settings_page.dialog)
    for name in ("sweep", "animate", "press", "paper"):
        getattr(window.studies, name)()
        show(driver, name, window.studies.dialogs[name])
    window.case_studies.design()
    for row in window.case_studies.dialog.varied.rows.values():
        row.check.setChecked(True)
    show(driver, "study", window.case_studies.dialog)
    window.help.open_sheet()
    driver.scene("shortcuts")
    window.help.close()


def show(driver, name, dialog):
    dialog.move(60, 30)
    driver.scene(name)
    dialog.close()
    driver.wait()
