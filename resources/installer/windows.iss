; The set-up program for Windows, by Inno Setup 6; build.py calls it with the version and the folder of the program,
; in build/installer, with the last line for each ending of a mesh.
; It needs no administrator: it installs for the user, unless one chooses otherwise.

[Setup]
AppId=apd-viewer
AppName=APD Viewer
AppVersion={#Version}
DefaultDirName={autopf}\APD Viewer
DefaultGroupName=APD Viewer
DisableProgramGroupPage=yes
PrivilegesRequired=lowest
PrivilegesRequiredOverridesAllowed=dialog
ArchitecturesAllowed=x64compatible
ArchitecturesInstallIn64BitMode=x64compatible
ChangesAssociations=yes
Compression=lzma2/normal
SolidCompression=yes
OutputBaseFilename=apd-viewer-{#Version}-windows
UninstallDisplayIcon={app}\apd-viewer.exe
LicenseFile=..\..\LICENSE

[Tasks]
Name: desktopicon; Description: "{cm:CreateDesktopIcon}"; Flags: unchecked

[Files]
Source: "{#Program}\*"; DestDir: "{app}"; Flags: recursesubdirs ignoreversion

[Icons]
Name: "{group}\APD Viewer"; Filename: "{app}\apd-viewer-window.exe"
Name: "{autodesktop}\APD Viewer"; Filename: "{app}\apd-viewer-window.exe"; Tasks: desktopicon

[Registry]
; Sessions are its own; meshes stay with the program that has them, and list it under Open with.
Root: HKA; Subkey: "Software\Classes\APDViewer.Session"; ValueType: string; ValueData: "APD Viewer session"; Flags: uninsdeletekey
Root: HKA; Subkey: "Software\Classes\APDViewer.Session\DefaultIcon"; ValueType: string; ValueData: "{app}\apd-viewer.exe,0"
Root: HKA; Subkey: "Software\Classes\APDViewer.Session\shell\open\command"; ValueType: string; ValueData: """{app}\apd-viewer-window.exe"" --clicked ""%1"""
Root: HKA; Subkey: "Software\Classes\APDViewer.Mesh"; ValueType: string; ValueData: "3D mesh"; Flags: uninsdeletekey
Root: HKA; Subkey: "Software\Classes\APDViewer.Mesh\DefaultIcon"; ValueType: string; ValueData: "{app}\apd-viewer.exe,0"
Root: HKA; Subkey: "Software\Classes\APDViewer.Mesh\shell\open\command"; ValueType: string; ValueData: """{app}\apd-viewer-window.exe"" --clicked ""%1"""
Root: HKA; Subkey: "Software\Classes\.apd"; ValueType: string; ValueData: "APDViewer.Session"; Flags: uninsdeletevalue
Root: HKA; Subkey: "Software\Classes\.{ending}\OpenWithProgids"; ValueType: string; ValueName: "APDViewer.Mesh"; Flags: uninsdeletevalue
